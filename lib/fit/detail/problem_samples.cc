#include "fit/detail/problem_samples.h"

#include "fit/detail/streams.h"
#include "sample/source_points.h"
#include "sample/surface_samples.h"

namespace innermap {

Points positionsOf(const Solid& solid, const std::vector<SurfacePoint>& onSurface) {
  return interpolate(solid.surface().vertices, solid.surface().triangles, onSurface);
}

ProblemSamples drawSamples(const Solid& solid, const PointCounts& counts, std::uint64_t seed) {
  SampleSettings sample;
  sample.seed = seedOf(seed, Stream::collocation);
  ProblemSamples out;
  out.collocation = blueNoiseSamples(solid.surface(), counts.collocation, sample);
  sample.seed = seedOf(seed, Stream::heldOut);
  out.heldOut = randomSamples(solid.surface(), counts.heldOut, sample);
  return out;
}

FitProblem problemOf(const Solid& solid,
                     const std::function<Matrix(const std::vector<SurfacePoint>&)>& values,
                     const ProblemSamples& samples, std::uint64_t seed) {
  FitProblem problem;
  problem.surface = {positionsOf(solid, samples.collocation), positionsOf(solid, samples.heldOut),
                     values(samples.collocation), values(samples.heldOut)};
  problem.diagonal = solid.diagonal();
  problem.area = solid.area();
  SourceSettings source;
  source.seed = seedOf(seed, Stream::sources);
  problem.placeSources = [solid, source](std::size_t count, double distance) mutable {
    source.count = count;
    return sourceShell(solid, distance, source);
  };
  return problem;
}

}  // namespace innermap
