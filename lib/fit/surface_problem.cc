#include "innermap/fit/surface_problem.h"

#include "fit/detail/problem_samples.h"
#include "fit/detail/streams.h"
#include "sample/patch_points.h"
#include "sample/surface_samples.h"

namespace innermap {
namespace {

using Samples = std::vector<SurfacePoint>;

BoundarySamples withValues(const Solid& solid, const SurfaceValues& values,
                           const SurfaceDirections& directions, const Samples& samples) {
  BoundarySamples out{positionsOf(solid, samples), values(samples)};
  if (directions) out.directions = directions(samples);
  return out;
}

PatchSettings patchSettings(const PlacementRequest& request, std::uint64_t seed) {
  PatchSettings s;
  s.spacing = request.spacing;
  s.reach = request.reach;
  s.most = request.most;
  s.seed = seed;
  return s;
}

}  // namespace

FitProblem surfaceProblem(const Solid& solid, const SurfaceValues& values,
                          const SurfaceProblemSettings& settings) {
  PointCounts counts;
  counts.collocation = settings.collocation;
  counts.heldOut = settings.heldOut;
  const ProblemSamples samples = drawSamples(solid, counts, settings.seed);
  FitProblem problem = problemOf(solid, values, samples, settings.seed);
  if (settings.directions) {
    problem.surface.directions = settings.directions(samples.collocation);
    problem.surface.heldOutDirections = settings.directions(samples.heldOut);
  }
  return problem;
}

AdaptiveProblem adaptiveProblem(const Solid& solid, const SurfaceValues& values, double unit,
                                const AdaptiveProblemSettings& settings) {
  const auto seed = [first = settings.seed](Stream stream, std::uint64_t index) {
    return seedOf(first, stream, index);
  };
  const SurfaceDirections directions = settings.directions;
  AdaptiveProblem problem;
  problem.diagonal = solid.diagonal();
  problem.area = solid.area();
  problem.unit = unit;
  problem.draw = [=](std::size_t count, std::uint64_t draw) {
    SampleSettings sample;
    sample.seed = seed(Stream::fresh, draw);
    return withValues(solid, values, directions, randomSamples(solid.surface(), count, sample));
  };
  problem.placeSources = [=](const PlacementRequest& request, double distance) {
    return patchSources(solid, request.marks, distance, request.existing,
                        patchSettings(request, seed(Stream::sources, request.index)));
  };
  problem.placeCollocation = [=](const PlacementRequest& request) {
    return withValues(
        solid, values, directions,
        patchSamples(solid, request.marks, request.existing,
                     patchSettings(request, seed(Stream::collocation, request.index))));
  };
  return problem;
}

BoundarySamples freshSamples(const Solid& solid, const SurfaceValues& values,
                             const FreshSampleSettings& settings) {
  SampleSettings sample;
  sample.seed = seedOf(settings.seed, Stream::fresh);
  return withValues(solid, values, settings.directions,
                    randomSamples(solid.surface(), settings.count, sample));
}

}  // namespace innermap
