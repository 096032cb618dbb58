#include "innermap/levelset/solid.h"

#include <tbb/task_arena.h>

#include <mutex>
#include <numeric>

#include "innermap/levelset/detail/exposed_surface.h"
#include "innermap/levelset/detail/grid_volume.h"
#include "innermap/mesh/triangle_tree.h"
#include "innermap/mesh/winding_number.h"

namespace innermap {

struct Solid::Implementation {
  RepairedMesh repaired;
  ExposedSurface exposed;
  std::vector<int> identity;  // parents and corners where all is exposed
  std::vector<PieceCorners> identityCorners;
  Box3 box;
  double area = 0;
  TriangleTree tree;
  WindingNumber winding;
  mutable std::once_flag volumeOnce;
  mutable double volume = 0;

  Implementation(RepairedMesh mesh, ExposedSurface surface)
      : repaired(std::move(mesh)),
        exposed(std::move(surface)),
        tree(this->surface().vertices, this->surface().triangles),
        winding(repaired.mesh.vertices, repaired.mesh.triangles) {
    box = boundingBox(this->surface());
    area = surfaceArea(this->surface());
    if (exposed.whole) {
      identity.resize(repaired.mesh.triangles.size());
      std::iota(identity.begin(), identity.end(), 0);
      identityCorners.assign(identity.size(), {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
    }
  }

  const Mesh& surface() const { return exposed.whole ? repaired.mesh : exposed.mesh; }
};

namespace {

void checkSettings(const SolidSettings& settings) {
  if (!(settings.pieceSize > 0 && settings.pieceSize < 1)) {
    throw SettingError("pieceSize", "must lie between 0 and 1 (fraction of the diagonal)");
  }
}

}  // namespace

Solid::Solid(const Mesh& mesh, const SolidSettings& settings) {
  checkSettings(settings);
  RepairSettings repairSettings;
  repairSettings.progress = settings.progress;
  RepairedMesh repaired = repair(mesh, repairSettings);
  ExposedSurface exposed = exposedSurface(repaired.mesh, settings.pieceSize, settings.progress);
  implementation_ = std::make_shared<const Implementation>(std::move(repaired), std::move(exposed));
}

const RepairedMesh& Solid::repaired() const { return implementation_->repaired; }

const Mesh& Solid::surface() const { return implementation_->surface(); }

const std::vector<int>& Solid::pieceParent() const {
  return implementation_->exposed.whole ? implementation_->identity
                                        : implementation_->exposed.parent;
}

const std::vector<PieceCorners>& Solid::pieceCorners() const {
  return implementation_->exposed.whole ? implementation_->identityCorners
                                        : implementation_->exposed.corners;
}

SurfacePoint Solid::address(const SurfacePoint& onSurface) const {
  if (implementation_->exposed.whole) return onSurface;
  const PieceCorners& corners = implementation_->exposed.corners.at(onSurface.triangle);
  SurfacePoint result;
  result.triangle = implementation_->exposed.parent[onSurface.triangle];
  for (int k = 0; k < 3; ++k) {
    result.barycentric[k] = 0;
    for (int c = 0; c < 3; ++c) result.barycentric[k] += onSurface.barycentric[c] * corners[c][k];
  }
  return result;
}

bool Solid::overlaps() const { return !implementation_->exposed.whole; }
const Box3& Solid::box() const { return implementation_->box; }
double Solid::diagonal() const { return implementation_->box.diagonal(); }
double Solid::area() const { return implementation_->area; }
double Solid::gap() const { return implementation_->exposed.gap; }

double Solid::volume() const {
  const Implementation& i = *implementation_;
  std::call_once(i.volumeOnce, [&] {
    const bool closed = i.exposed.doubledArea <= 1e-4 * i.area && i.exposed.gap <= diagonal() / 64;
    // Isolated: a thread that waits in here must not take up a task that asks for the volume too.
    tbb::this_task_arena::isolate(
        [&] { i.volume = closed ? signedVolume(i.surface()) : gridVolume(*this, 256); });
  });
  return i.volume;
}

bool Solid::inside(const Vec3& p) const { return implementation_->winding.wholeAt(p) > 0; }

double Solid::distance(const Vec3& p) const { return implementation_->tree.closest(p).distance; }

double Solid::signedDistance(const Vec3& p) const {
  const double d = distance(p);
  return inside(p) ? -d : d;
}

Solid::Closest Solid::closest(const Vec3& p, double within) const {
  const ClosestPoint found = implementation_->tree.closest(p, within);
  return {found.address, found.position, found.distance};
}

}  // namespace innermap
