#include "pairs.h"

#include <cmath>

#include "innermap/field/fit.h"
#include "innermap/fit/boundary_pair.h"
#include "innermap/fit/surface_problem.h"
#include "innermap/mesh/mesh_file.h"

namespace innermap::bench {
namespace {

constexpr double kTwist = 1.57079632679489661923, kBend = 0.5 * kTwist;
constexpr std::size_t kFresh = 30000;
constexpr std::uint64_t kFreshSeed = 0x6672657368;  // far from those that users give

int longestAxis(const Box3& box) {
  const Vec3 e = box.extent();
  return e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
}

}  // namespace

std::vector<Pair> poses(const Options& options) {
  std::vector<Pair> pairs;
  for (int pose = 1; pose <= 5; ++pose) {
    const std::string name = "pose-0" + std::to_string(pose);
    pairs.push_back({name, options.model("horse-poses/reference.obj"),
                     options.model("horse-poses/" + name + ".obj")});
  }
  return pairs;
}

Vec3 bentAndTwisted(const Vec3& p, const Box3& box) {
  const int a = longestAxis(box), b = (a + 1) % 3, c = (a + 2) % 3;
  const double length = box.extent()[a];
  const Vec3 d = p - box.center();
  const double turn = kTwist * d[a] / length;
  const double y = std::cos(turn) * d[b] - std::sin(turn) * d[c];
  const double z = std::sin(turn) * d[b] + std::cos(turn) * d[c];
  // The axis becomes an arc of the same length about a centre at distance `radius`.
  const double radius = length / kBend, angle = d[a] / radius;
  Vec3 q;
  q[a] = (radius - y) * std::sin(angle);
  q[b] = radius - (radius - y) * std::cos(angle);
  q[c] = z;
  return box.center() + q;
}

Pair bentAndTwistedPair(const std::string& name, const Options& options) {
  Pair pair{name, options.model(name + ".obj"), options.scratch + "/" + name + ".bent.obj"};
  Mesh mesh = readMesh(pair.source);
  const Box3 box = boundingBox(mesh);
  for (Vec3& p : mesh.vertices) p = bentAndTwisted(p, box);
  writeMesh(pair.target, mesh);
  return pair;
}

FreshError freshError(const HarmonicField& field, const Pair& pair) {
  const Mesh source = readMesh(pair.source), target = readMeshLike(pair.target, source);
  const BoundaryPair boundary = makeBoundaryPair(source, target);
  FreshSampleSettings settings;
  settings.count = kFresh;
  settings.seed = kFreshSeed;
  const BoundarySamples fresh = freshSamples(
      boundary.solid(),
      [&](const std::vector<SurfacePoint>& samples) { return boundary.targetsOf(samples); },
      settings);
  const BoundaryError error =
      measureBoundaryError(field, fresh.points, fresh.values, boundary.target.diagonal);
  return {error.rms, error.p99, error.max};
}

}  // namespace innermap::bench
