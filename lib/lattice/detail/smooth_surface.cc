#include "lattice/detail/smooth_surface.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/point_grid.h"
#include "innermap/core/run.h"
#include "levelset/crossing_lines.h"

namespace innermap {
namespace {

// Measured with maps of bodies that cross themselves: five rounds take as few charges as three and
// round edges more; where many vertices come to the limit of their way, that makes new teeth.
constexpr int kRounds = 3;
constexpr double kShare = 0.5;            // of the way to the neighbours' mean, each round
constexpr double kMostMoved = 1;          // spacings
constexpr double kOff = 0.1;              // spacings from the solid's surface
constexpr double kSharpestCosine = 0.5;   // of normals of triangles around a vertex
constexpr double kBesideCrossings = 4;    // spacings from where the mesh runs through itself
constexpr double kLinePointsApart = 0.5;  // spacings between points of those lines

using Marks = std::vector<std::uint8_t>;  // #vertices

struct Fan {
  std::vector<int> triangles, neighbours;
};

std::vector<Fan> fansOf(const Mesh& mesh) {
  std::vector<Fan> fans(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      Fan& fan = fans[mesh.triangles[t][k]];
      fan.triangles.push_back(static_cast<int>(t));
      fan.neighbours.push_back(mesh.triangles[t][(k + 1) % 3]);
    }
  return fans;
}

bool isSharp(const Mesh& mesh, const Fan& fan) {
  for (const int s : fan.triangles)
    for (const int t : fan.triangles) {
      const Vec3 a = areaVector(mesh, s), b = areaVector(mesh, t);
      if (dot(a, b) < kSharpestCosine * norm(a) * norm(b)) return true;
    }
  return false;
}

Marks roughVertices(const Solid& solid, double spacing, const Mesh& mesh,
                    const std::vector<Fan>& fans) {
  PointGrid crossings(kBesideCrossings * spacing);
  for (const CrossingPoint& p : exposedCrossings(solid, kLinePointsApart * spacing))
    crossings.add(p.place);
  Marks rough(fans.size());
  parallelBlocks(
      fans.size(), 256,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
          const Vec3& at = mesh.vertices[v];
          rough[v] =
              solid.distance(at) > kOff * spacing ||
              (crossings.anyNearer(at, kBesideCrossings * spacing) && isSharp(mesh, fans[v]));
        }
      },
      "smoothing the surface");
  Marks all = rough;
  for (std::size_t v = 0; v < fans.size(); ++v)
    if (rough[v])
      for (const int w : fans[v].neighbours) all[w] = 1;
  return all;
}

}  // namespace

Points smoothedWhereRough(const Solid& solid, double spacing, const Mesh& mesh) {
  const std::vector<Fan> fans = fansOf(mesh);
  const Marks moves = roughVertices(solid, spacing, mesh, fans);
  Points now = mesh.vertices;
  for (int round = 0; round < kRounds; ++round) {
    Points next = now;
    for (std::size_t v = 0; v < fans.size(); ++v) {
      if (!moves[v]) continue;
      Vec3 mean;
      for (const int w : fans[v].neighbours)
        mean = mean + now[w] / static_cast<double>(fans[v].neighbours.size());
      const Vec3 way = now[v] + kShare * (mean - now[v]) - mesh.vertices[v];
      next[v] = mesh.vertices[v] + std::min(1.0, kMostMoved * spacing / norm(way)) * way;
    }
    now = std::move(next);
  }
  return now;
}

}  // namespace innermap
