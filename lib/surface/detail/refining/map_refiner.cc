#include "surface/detail/refining/map_refiner.h"

#include <utility>

namespace innermap {
namespace {

constexpr double kSamples =
    10000;  // of the energy, at least; three times more change it by half a percent

// More sweeps win less than a thousandth of the energy (measured on the pairs of the benchmarks).
RelaxSettings relaxation(const RefineSettings& settings) {
  RelaxSettings relax;
  relax.sweeps = settings.relax ? 4 : 0;
  relax.lastSweeps = settings.relax ? 10 : 0;
  relax.steps = 1;
  relax.enough = 2e-3;
  relax.parallel = true;
  relax.stage = "refining the map";
  return relax;
}

}  // namespace

MapRefiner::MapRefiner(const ClosedSurface& surface, const ProgressiveMesh& mesh,
                       const CoarseSurface& coarse, const CoarseMap& start,
                       const TargetMetric& target, const RefineSettings& settings)
    : surface_(surface),
      mesh_(mesh),
      image_(startImage(surface, coarse, start)),
      energy_(surface, mesh_, image_, target, kSamples),
      fine_(mesh_, image_, energy_, settings.fixed, relaxation(settings)),
      origin_(start.origin) {
  fine_.relaxAll(settings.relax ? 15 : 0);
}

Layout MapRefiner::startImage(const ClosedSurface& surface, const CoarseSurface& coarse,
                              const CoarseMap& start) {
  Layout image = start.image;
  image.place.assign(surface.vertices.size(), Vec3{0, 0, 1});
  for (std::size_t i = 0; i < coarse.vertex.size(); ++i)
    image.place[coarse.vertex[i]] = start.image.place[i];
  if (!image.shift.empty()) image.shift.resize(surface.triangles.size());
  return image;
}

bool MapRefiner::refineTo(std::size_t vertices) { return fine_.refine(vertices) < 0; }

RefinedSoFar MapRefiner::soFar() const {
  RefinedSoFar out{coarseSurface(surface_, mesh_), {}};
  out.image.space = image_.space;
  for (const int v : out.surface.vertex) out.image.place.push_back(image_.place[v]);
  return out;
}

Layout MapRefiner::takeImage() {
  for (std::size_t t = 0; t < image_.shift.size(); ++t)
    for (int k = 0; k < 3; ++k) image_.shift[t][k] = mesh_.shift(static_cast<int>(t), k);
  return std::move(image_);
}

}  // namespace innermap
