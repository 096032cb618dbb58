#include "innermap/levelset/solid.h"

#include <tbb/task_arena.h>

#include <limits>
#include <mutex>

#include "innermap/core/error.h"
#include "levelset/detail/exposed_surface.h"
#include "levelset/detail/narrow_band.h"
#include "levelset/detail/solid_body.h"

namespace innermap {

struct Solid::Implementation {
  Implementation(RepairedMesh mesh, ExposedSurface surface)
      : body(std::move(mesh), std::move(surface)) {}

  SolidBody body;
  mutable std::once_flag volumeOnce;
  mutable double volume = 0;
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
  requireNearOrigin(mesh);
  RepairedMesh repaired = repair(mesh);
  ExposedSurface exposed = exposedSurface(repaired.mesh, settings.pieceSize);
  implementation_ = std::make_shared<const Implementation>(std::move(repaired), std::move(exposed));
}

const SolidBody& Solid::body() const { return implementation_->body; }
const RepairedMesh& Solid::repaired() const { return body().repaired(); }
const Mesh& Solid::surface() const { return body().surface(); }

SurfacePoint Solid::address(const SurfacePoint& onSurface) const {
  const ExposedSurface& exposed = body().exposed();
  if (exposed.whole) return onSurface;
  const PieceCorners& corners = exposed.corners.at(onSurface.triangle);
  SurfacePoint result;
  result.triangle = exposed.parent[onSurface.triangle];
  for (int k = 0; k < 3; ++k) {
    result.barycentric[k] = 0;
    for (int c = 0; c < 3; ++c) result.barycentric[k] += onSurface.barycentric[c] * corners[c][k];
  }
  return result;
}

bool Solid::overlaps() const { return !body().exposed().whole; }
double Solid::insideOut() const { return body().exposed().negativeShare; }
const Box3& Solid::box() const { return body().box(); }
double Solid::diagonal() const { return body().box().diagonal(); }
double Solid::area() const { return body().area(); }
double Solid::gap() const { return body().gap(); }

double Solid::volume() const {
  const Implementation& i = *implementation_;
  std::call_once(i.volumeOnce, [&] {
    // Isolated: a thread that waits in here must not take up a task that asks for the volume too.
    tbb::this_task_arena::isolate([&] {
      i.volume = i.body.closedWellEnough() ? i.body.enclosedVolume() : gridVolume(i.body, 256);
    });
  });
  return i.volume;
}

bool Solid::inside(const Vec3& p) const { return body().inside(p); }

double Solid::distance(const Vec3& p) const {
  return body().closest(p, std::numeric_limits<double>::infinity()).distance;
}

double Solid::signedDistance(const Vec3& p) const {
  const double d = distance(p);
  return inside(p) ? -d : d;
}

Solid::Closest Solid::closest(const Vec3& p, double within) const {
  const ClosestPoint found = body().closest(p, within);
  return {found.address, found.position, found.distance};
}

}  // namespace innermap
