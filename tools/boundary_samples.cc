#include "boundary_samples.h"

#include <algorithm>

#include "innermap/core/detail/random.h"
#include "innermap/sample/patch_points.h"
#include "innermap/sample/source_points.h"
#include "innermap/sample/surface_samples.h"

namespace innermap::tool {
namespace {

// Seeds of the three sets of boundary points, so that none has a point of another.
enum Stream : std::uint64_t {
  kCollocation = 0,
  kHeldOut = 1,
  kFresh = 2,
  kSources = 3,
  kVertices = 4
};

std::uint64_t seedOf(std::uint64_t seed, Stream stream) { return 4 * seed + stream; }

std::uint64_t seedOf(const FittingOptions& options, Stream stream) {
  return seedOf(options.seed, stream);
}

Points positionsOf(const Mesh& mesh, const std::vector<SurfacePoint>& samples) {
  return interpolate(mesh.vertices, mesh.triangles, samples);
}

using Samples = std::vector<SurfacePoint>;

// Samples on caps, which have no vertices of the mesh's own.
Samples onCaps(const BoundaryPair& pair, const Samples& samples) {
  Samples out;
  for (const SurfacePoint& p : samples)
    if (pair.solid.repaired().parent[pair.solid.address(p).triangle] < 0) out.push_back(p);
  return out;
}

// The mesh's own vertices on the boundary (not buried ones), shuffled, and samples of the caps; a
// fifth of the vertices is held out.
BoundaryData vertexData(const BoundaryPair& pair, const FittingOptions& options,
                        const PointCounts& counts, const Samples& collocation) {
  const Mesh& mesh = pair.solid.repaired().mesh;
  std::vector<char> used(pair.source.vertices.size(), 0);
  for (const Triangle& t : mesh.triangles)
    for (const int v : t)
      if (static_cast<std::size_t>(v) < used.size()) used[v] = 1;
  const double touching = 1e-9 * pair.solid.diagonal();
  std::vector<std::pair<std::uint64_t, std::size_t>> order;
  const CounterRandom random(options.seed, kVertices);
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v] && (!pair.solid.overlaps() || pair.solid.distance(mesh.vertices[v]) <= touching))
      order.emplace_back(random.bits(v), v);
  std::sort(order.begin(), order.end());
  const std::size_t heldOut = std::min(order.size() / 5, counts.heldOut),
                    points = std::min(order.size() - heldOut, counts.collocation);
  const Samples caps = onCaps(pair, collocation);
  BoundaryData data{positionsOf(pair.solid.surface(), caps),
                    {},
                    Matrix(caps.size() + points, 3),
                    Matrix(heldOut, 3)};
  const Matrix capValues = pair.targetsOf(caps);
  for (std::size_t i = 0; i < caps.size(); ++i)
    for (int a = 0; a < 3; ++a) data.values(i, a) = capValues(i, a);
  const auto add = [&](std::size_t v, Points& to, Matrix& values) {
    for (int a = 0; a < 3; ++a) values(to.size(), a) = pair.moved[v][a];
    to.push_back(mesh.vertices[v]);
  };
  for (std::size_t i = 0; i < heldOut; ++i) add(order[i].second, data.heldOut, data.heldOutValues);
  for (std::size_t i = 0; i < points; ++i) add(order[heldOut + i].second, data.points, data.values);
  return data;
}

}  // namespace

namespace {

// Blue noise to fit to, and random points to judge by.
struct SurfaceSamples {
  Samples collocation, heldOut;
};

SurfaceSamples surfaceSamples(const Mesh& surface, std::uint64_t seed, const PointCounts& counts,
                              Context& context) {
  SampleSettings sample;
  sample.progress = context.progress();
  sample.seed = seedOf(seed, kCollocation);
  SurfaceSamples out;
  out.collocation = blueNoiseSamples(surface, counts.collocation, sample);
  sample.seed = seedOf(seed, kHeldOut);
  out.heldOut = randomSamples(surface, counts.heldOut, sample);
  return out;
}

FitProblem problemOf(const Solid& solid, const ValuesOf& values, std::uint64_t seed,
                     const SurfaceSamples& samples, Context& context) {
  const Mesh& surface = solid.surface();
  FitProblem problem;
  problem.surface = {positionsOf(surface, samples.collocation),
                     positionsOf(surface, samples.heldOut), values(samples.collocation),
                     values(samples.heldOut)};
  problem.diagonal = solid.diagonal();
  problem.area = solid.area();
  SourceSettings source;
  source.seed = seedOf(seed, kSources);
  source.progress = context.progress();
  problem.placeSources = [&solid, source](std::size_t count, double distance) mutable {
    source.count = count;
    return sourceShell(solid, distance, source);
  };
  return problem;
}

}  // namespace

FitProblem surfaceProblem(const Solid& solid, const ValuesOf& values, std::uint64_t seed,
                          const PointCounts& counts, Context& context) {
  return problemOf(solid, values, seed, surfaceSamples(solid.surface(), seed, counts, context),
                   context);
}

FitProblem fitProblem(const BoundaryPair& pair, const FittingOptions& options,
                      const PointCounts& counts, Context& context) {
  const SurfaceSamples samples =
      surfaceSamples(pair.solid.surface(), options.seed, counts, context);
  const ValuesOf values = [&pair](const Samples& points) { return pair.targetsOf(points); };
  FitProblem problem = problemOf(pair.solid, values, options.seed, samples, context);
  if (options.interpolation != "linear")
    problem.vertices = vertexData(pair, options, counts, samples.collocation);
  if (options.radiusRatio) {
    SourceSettings source;
    source.seed = seedOf(options, kSources);
    source.progress = context.progress();
    problem.placeSources = [&pair, &options, source](std::size_t count, double) mutable {
      source.count = count;
      return sourceSphere(pair.solid, *options.radiusRatio, source);
    };
  }
  return problem;
}

BoundarySamples freshSamples(const Solid& solid, const ValuesOf& values, std::uint64_t seed,
                             Context& context) {
  SampleSettings sample;
  sample.seed = seedOf(seed, kFresh);
  sample.progress = context.progress();
  const Samples fresh = randomSamples(solid.surface(), kFreshSamples, sample);
  return {positionsOf(solid.surface(), fresh), values(fresh)};
}

BoundarySamples freshSamples(const BoundaryPair& pair, const FittingOptions& options,
                             Context& context) {
  return freshSamples(
      pair.solid, [&pair](const Samples& points) { return pair.targetsOf(points); }, options.seed,
      context);
}

AdaptiveProblem adaptiveProblem(const BoundaryPair& pair, const FittingOptions& options,
                                Context& context) {
  const auto seed = [&options](Stream stream, std::uint64_t index) {
    return seedOf(options, stream) + (index << 53);  // seeds stay below that
  };
  const auto patch = [seed, &context](const PlacementRequest& request, Stream stream) {
    PatchSettings s;
    s.spacing = request.spacing;
    s.reach = request.reach;
    s.most = request.most;
    s.seed = seed(stream, request.index);
    s.progress = context.progress();
    return s;
  };
  const auto withTargets = [&pair](const Samples& samples) {
    return BoundarySamples{positionsOf(pair.solid.surface(), samples), pair.targetsOf(samples)};
  };
  AdaptiveProblem problem;
  problem.diagonal = pair.solid.diagonal();
  problem.area = pair.solid.area();
  problem.unit = pair.targetDiagonal;
  problem.draw = [=, &pair, &context](std::size_t count, std::uint64_t draw) {
    SampleSettings sample;
    sample.seed = seed(kFresh, draw);
    sample.progress = context.progress();
    return withTargets(randomSamples(pair.solid.surface(), count, sample));
  };
  problem.placeSources = [=, &pair](const PlacementRequest& request, double distance) {
    return patchSources(pair.solid, request.marks, distance, request.existing,
                        patch(request, kSources));
  };
  problem.placeCollocation = [=, &pair](const PlacementRequest& request) {
    return withTargets(
        patchSamples(pair.solid, request.marks, request.existing, patch(request, kCollocation)));
  };
  return problem;
}

}  // namespace innermap::tool
