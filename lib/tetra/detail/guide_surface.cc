#include "tetra/detail/guide_surface.h"

#include <algorithm>
#include <queue>
#include <tuple>

namespace innermap {
namespace {

constexpr double kOnEdge = 1e-6;    // barycentric
constexpr double kCreased = 0.766;  // cosine of 40 degrees
constexpr int kFruitless = 24;      // triangles tried without a nearer point

// Vertices that files doubled along seams are one where they are in one place.
std::vector<int> joinedByPlace(const Points& vertices) {
  std::vector<int> order(vertices.size()), joined(vertices.size());
  for (std::size_t v = 0; v < order.size(); ++v) order[v] = static_cast<int>(v);
  const auto key = [&](int v) {
    return std::make_tuple(vertices[v].x, vertices[v].y, vertices[v].z);
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    joined[order[i]] =
        i > 0 && key(order[i - 1]) == key(order[i]) ? joined[order[i - 1]] : order[i];
  return joined;
}

std::vector<std::array<int, 3>> acrossOf(const Points& vertices,
                                         const std::vector<Triangle>& triangles) {
  struct Side {
    int low, high, side;
  };
  const std::vector<int> joined = joinedByPlace(vertices);
  std::vector<Side> sides;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = joined[triangles[t][k]], b = joined[triangles[t][(k + 1) % 3]];
      if (a != b) sides.push_back({std::min(a, b), std::max(a, b), static_cast<int>(3 * t) + k});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.side) < std::tie(b.low, b.high, b.side);
  });
  std::vector<std::array<int, 3>> across(triangles.size(), {-1, -1, -1});
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const Side &a = sides[i], &b = sides[i + 1];
    if (a.low != b.low || a.high != b.high) continue;
    across[a.side / 3][a.side % 3] = b.side / 3;
    across[b.side / 3][b.side % 3] = a.side / 3;
  }
  return across;
}

}  // namespace

GuideSurface::GuideSurface(const Points& vertices, const std::vector<Triangle>& triangles)
    : vertices_(vertices),
      triangles_(triangles),
      across_(acrossOf(vertices, triangles)),
      tree_(vertices, triangles) {
  normals_.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const Vec3 n = cross(vertices[t[1]] - vertices[t[0]], vertices[t[2]] - vertices[t[0]]);
    normals_.push_back(norm(n) > 0 ? n / norm(n) : Vec3{});
  }
}

Vec3 GuideSurface::position(const SurfacePoint& point) const {
  const Triangle& t = triangles_[point.triangle];
  const auto& b = point.barycentric;
  return b[0] * vertices_[t[0]] + b[1] * vertices_[t[1]] + b[2] * vertices_[t[2]];
}

bool GuideSurface::onCrease(const SurfacePoint& point) const {
  for (int side = 0; side < 3; ++side) {
    // The side from its corner to the next is where the third coordinate vanishes.
    if (point.barycentric[(side + 2) % 3] > kOnEdge) continue;
    const int next = across_[point.triangle][side];
    if (next >= 0 && dot(normals_[next], normals_[point.triangle]) < kCreased) return true;
  }
  return false;
}

ClosestPoint GuideSurface::onTriangle(int triangle, const Vec3& p) const {
  const Triangle& t = triangles_[triangle];
  ClosestPoint found = closestOnTriangle(p, {vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]});
  found.address.triangle = triangle;
  return found;
}

ClosestPoint GuideSurface::closestFrom(int triangle, const Vec3& p) const {
  using Open = std::pair<double, int>;  // nearest first, then the lowest number
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  std::vector<int> seen{triangle};
  ClosestPoint best = onTriangle(triangle, p);
  open.push({best.distance, triangle});
  for (int fruitless = 0; !open.empty() && fruitless < kFruitless; ++fruitless) {
    const int at = open.top().second;
    open.pop();
    for (const int next : across_[at]) {
      if (next < 0 || std::find(seen.begin(), seen.end(), next) != seen.end()) continue;
      seen.push_back(next);
      const ClosestPoint found = onTriangle(next, p);
      open.push({found.distance, next});
      if (found.distance < best.distance) {
        best = found;
        fruitless = 0;
      }
    }
  }
  return best;
}

}  // namespace innermap
