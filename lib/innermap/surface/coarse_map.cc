#include "innermap/surface/coarse_map.h"

#include "innermap/surface/pullback_energy.h"

namespace innermap {
namespace {

constexpr double kSamples = 6000;  // of the energy, while a coarse map is found
constexpr int kSweeps = 12;

}  // namespace

CoarseSurface coarseSurface(const ClosedSurface& surface, const ProgressiveMesh& mesh) {
  CoarseSurface out;
  out.surface.name = surface.name;
  out.surface.genus = surface.genus;
  out.index.assign(mesh.capacity(), -1);
  for (int v = 0; v < static_cast<int>(mesh.capacity()); ++v) {
    if (!mesh.present(v)) continue;
    out.index[v] = static_cast<int>(out.vertex.size());
    out.vertex.push_back(v);
    out.surface.vertices.push_back(surface.vertices[v]);
  }
  for (int t = 0; t < static_cast<int>(mesh.triangleCount()); ++t) {
    if (!mesh.alive(t)) continue;
    const Triangle& tri = mesh.triangle(t);
    out.surface.triangles.push_back({out.index[tri[0]], out.index[tri[1]], out.index[tri[2]]});
    if (surface.genus > 0)
      out.shift.push_back({mesh.shift(t, 0), mesh.shift(t, 1), mesh.shift(t, 2)});
  }
  return out;
}

std::optional<CoarseMap> relaxCoarse(const CoarseSurface& coarse, const Layout& start,
                                     const TargetMetric& target, const CoarseMapSettings& settings,
                                     int* blocked) {
  CoarseMap out;
  out.image = start;
  const std::size_t vertices = coarse.surface.vertices.size();
  ProgressiveMesh mesh(vertices, coarse.surface.triangles, coarse.shift);
  PullbackEnergy energy(coarse.surface, mesh, out.image, target, kSamples);
  RelaxSettings relax;
  relax.progress = settings.progress;
  std::vector<char> fixed(vertices, 0), held(vertices, 0);
  for (const Anchor& a : settings.fixed) fixed[a.vertex] = held[a.vertex] = 1;
  for (const Anchor& a : settings.drawn) held[a.vertex] = 1;
  std::vector<Anchor> anchors = settings.fixed;
  anchors.insert(anchors.end(), settings.drawn.begin(), settings.drawn.end());
  CoarseToFine holding(mesh, out.image, energy, held, relax);
  const int stuck = pullAnchors(mesh, out.image, anchors, holding, settings.progress);
  if (stuck >= 0) {
    if (blocked) *blocked = stuck;
    return std::nullopt;
  }
  CoarseToFine free(mesh, out.image, energy, fixed, relax);
  free.relaxAll(kSweeps);
  out.energy = energy.total();
  return out;
}

std::optional<CoarseMap> refineMap(const ClosedSurface& surface, ProgressiveMesh mesh,
                                   const CoarseSurface& coarse, const CoarseMap& start,
                                   const TargetMetric& target, const RefineSettings& settings) {
  CoarseMap out;
  out.origin = start.origin;
  out.image = start.image;
  out.image.place.assign(surface.vertices.size(), Vec3{0, 0, 1});
  for (std::size_t i = 0; i < coarse.vertex.size(); ++i)
    out.image.place[coarse.vertex[i]] = start.image.place[i];
  if (!out.image.shift.empty()) out.image.shift.resize(surface.triangles.size());
  PullbackEnergy energy(surface, mesh, out.image, target);
  RelaxSettings relax;
  relax.sweeps = settings.relax ? 2 : 0;
  relax.lastSweeps = settings.relax ? 3 : 0;
  relax.steps = 1;
  relax.stage = "refining the map";
  relax.progress = settings.progress;
  CoarseToFine fine(mesh, out.image, energy, settings.fixed, relax);
  fine.relaxAll(relax.lastSweeps);
  if (fine.refine(surface.vertices.size()) >= 0) return std::nullopt;
  out.energy = energy.total();
  if (!out.image.shift.empty())
    for (int t = 0; t < static_cast<int>(surface.triangles.size()); ++t)
      for (int k = 0; k < 3; ++k) out.image.shift[t][k] = mesh.shift(t, k);
  return out;
}

}  // namespace innermap
