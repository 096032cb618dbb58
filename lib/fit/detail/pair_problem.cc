#include "fit/detail/pair_problem.h"

#include <algorithm>

#include "core/random.h"
#include "fit/detail/streams.h"
#include "sample/source_points.h"

namespace innermap {
namespace {

constexpr double kTouchingSurfaces = 1e-9;  // of the diagonal

using Samples = std::vector<SurfacePoint>;

// Samples on caps, which have no vertices of the mesh's own.
Samples onCaps(const Solid& solid, const Samples& samples) {
  Samples out;
  for (const SurfacePoint& p : samples)
    if (solid.repaired().parent[solid.address(p).triangle] < 0) out.push_back(p);
  return out;
}

// The mesh's own vertices on the boundary (not buried ones), shuffled.
std::vector<std::size_t> shuffledVertices(const SourceBoundary& source, std::uint64_t seed) {
  const Solid& solid = source.solid;
  const Mesh& mesh = solid.repaired().mesh;
  std::vector<char> used(source.mesh.vertices.size(), 0);
  for (const Triangle& t : mesh.triangles)
    for (const int v : t)
      if (static_cast<std::size_t>(v) < used.size()) used[v] = 1;
  const double touching = kTouchingSurfaces * solid.diagonal();
  std::vector<std::pair<std::uint64_t, std::size_t>> order;
  const CounterRandom random(seed, static_cast<std::uint64_t>(Stream::vertices));
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v] && (!solid.overlaps() || solid.distance(mesh.vertices[v]) <= touching))
      order.emplace_back(random.bits(v), v);
  std::sort(order.begin(), order.end());
  std::vector<std::size_t> out;
  for (const auto& [key, vertex] : order) out.push_back(vertex);
  return out;
}

// Vertices and samples of the caps; a fifth of the vertices is held out.
BoundaryData vertexData(const BoundaryPair& pair, std::uint64_t seed, const PointCounts& counts,
                        const Samples& collocation) {
  const Solid& solid = pair.solid();
  const std::vector<std::size_t> vertices = shuffledVertices(pair.source, seed);
  const std::size_t heldOut = std::min(vertices.size() / 5, counts.heldOut),
                    points = std::min(vertices.size() - heldOut, counts.collocation);
  const Samples caps = onCaps(solid, collocation);
  BoundaryData data{
      positionsOf(solid, caps), {}, Matrix(caps.size() + points, 3), Matrix(heldOut, 3)};
  const Matrix capValues = pair.targetsOf(caps);
  for (std::size_t i = 0; i < caps.size(); ++i)
    for (int a = 0; a < 3; ++a) data.values(i, a) = capValues(i, a);
  const auto add = [&](std::size_t v, Points& to, Matrix& values) {
    for (int a = 0; a < 3; ++a) values(to.size(), a) = pair.target.moved[v][a];
    to.push_back(solid.repaired().mesh.vertices[v]);
  };
  for (std::size_t i = 0; i < heldOut; ++i) add(vertices[i], data.heldOut, data.heldOutValues);
  for (std::size_t i = 0; i < points; ++i) add(vertices[heldOut + i], data.points, data.values);
  return data;
}

}  // namespace

FitProblem pairProblem(const BoundaryPair& pair, const PairProblemSettings& settings) {
  const Solid& solid = pair.solid();
  const ProblemSamples samples = drawSamples(solid, settings.counts, settings.seed);
  FitProblem problem = problemOf(
      solid, [&pair](const Samples& points) { return pair.targetsOf(points); }, samples,
      settings.seed);
  if (settings.vertices)
    problem.vertices = vertexData(pair, settings.seed, settings.counts, samples.collocation);
  if (settings.radiusRatio) {
    SourceSettings source;
    source.seed = seedOf(settings.seed, Stream::sources);
    problem.placeSources = [solid, ratio = *settings.radiusRatio, source](std::size_t count,
                                                                          double) mutable {
      source.count = count;
      return sourceSphere(solid, ratio, source);
    };
  }
  return problem;
}

}  // namespace innermap
