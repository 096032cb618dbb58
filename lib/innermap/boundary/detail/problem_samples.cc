#include "innermap/boundary/detail/problem_samples.h"

#include "innermap/boundary/detail/streams.h"
#include "innermap/sample/source_points.h"
#include "innermap/sample/surface_samples.h"

namespace innermap {

Points positionsOf(const Solid& solid, const std::vector<SurfacePoint>& onSurface) {
  return interpolate(solid.surface().vertices, solid.surface().triangles, onSurface);
}

ProblemSamples drawSamples(const Solid& solid, const SurfaceProblemSettings& settings) {
  SampleSettings sample;
  sample.progress = settings.progress;
  sample.seed = seedOf(settings.seed, Stream::collocation);
  ProblemSamples out;
  out.collocation = blueNoiseSamples(solid.surface(), settings.collocation, sample);
  sample.seed = seedOf(settings.seed, Stream::heldOut);
  out.heldOut = randomSamples(solid.surface(), settings.heldOut, sample);
  return out;
}

FitProblem problemOf(const Solid& solid, const SurfaceValues& values, const ProblemSamples& samples,
                     const SurfaceProblemSettings& settings) {
  FitProblem problem;
  problem.surface = {positionsOf(solid, samples.collocation), positionsOf(solid, samples.heldOut),
                     values(samples.collocation), values(samples.heldOut)};
  problem.diagonal = solid.diagonal();
  problem.area = solid.area();
  SourceSettings source;
  source.seed = seedOf(settings.seed, Stream::sources);
  source.progress = settings.progress;
  problem.placeSources = [solid, source](std::size_t count, double distance) mutable {
    source.count = count;
    return sourceShell(solid, distance, source);
  };
  return problem;
}

}  // namespace innermap
