#include "surface/detail/refining/coarse_map.h"

#include "surface/detail/refining/pullback_energy.h"

namespace innermap {
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
  PullbackEnergy energy(coarse.surface, mesh, out.image, target, settings.samples);
  RelaxSettings relax;
  relax.steps = 1;
  std::vector<char> fixed(vertices, 0), held(vertices, 0);
  for (const Anchor& a : settings.fixed) fixed[a.vertex] = held[a.vertex] = 1;
  for (const Anchor& a : settings.drawn) held[a.vertex] = 1;
  std::vector<Anchor> anchors = settings.fixed;
  anchors.insert(anchors.end(), settings.drawn.begin(), settings.drawn.end());
  CoarseToFine holding(mesh, out.image, energy, held, relax);
  FlowSettings flow;
  flow.exact = settings.fixed.size();
  flow.near = settings.near;
  flow.patience = settings.patience;
  const int stuck = pullAnchors(mesh, out.image, anchors, holding, flow);
  if (stuck >= 0) {
    if (blocked) *blocked = stuck;
    return std::nullopt;
  }
  CoarseToFine free(mesh, out.image, energy, fixed, relax);
  free.relaxAll(settings.sweeps);
  out.energy = energy.total();
  return out;
}

}  // namespace innermap
