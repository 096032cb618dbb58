#include "surface/detail/topology/linking.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "core/pi.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

// As a complex number, half the solid angle of the cone over three vectors is its argument (Van
// Oosterom and Strackee 1983).
std::complex<double> halfAngle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = norm(a), lb = norm(b), lc = norm(c);
  return {la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb, dot(a, cross(b, c))};
}

// The edges that the path to the left of a loop crosses, as half-edges that it crosses from left to
// right.
std::vector<int> leftPath(const HalfEdges& edges, const Loop& loop) {
  std::vector<int> path;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const int out = loop[(i + 1) % loop.size()];
    for (int h = edges.clockwise(edges.opposite(loop[i])); h != out; h = edges.clockwise(h))
      path.push_back(h);
  }
  return path;
}

// The angle from the triangle left of h around the outside to the one right of it, in [0, 2 pi).
double outerAngle(const Points& vertices, const HalfEdges& edges, int h) {
  const Vec3& origin = vertices[edges.tail(h)];
  const Vec3 axis = vertices[edges.head(h)] - origin;
  const Vec3 left = cross(axis, vertices[edges.apex(h)] - origin);
  const Vec3 right = cross(axis, vertices[edges.apex(edges.opposite(h))] - origin);
  const double angle = std::atan2(dot(axis, cross(left, right)), norm(axis) * dot(left, right));
  return angle < 0 ? angle + 2 * kPi : angle;
}

double linkingIntegral(const Points& vertices, const HalfEdges& edges, const Loop& loop,
                       const std::vector<int>& path) {
  std::vector<int> used;  // edges of the loop
  for (const int h : loop) used.push_back(edges.edge(h));
  Points middle;
  for (const int h : path)
    middle.push_back(0.5 * (vertices[edges.tail(h)] + vertices[edges.head(h)]));
  double sum = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const int h = loop[i];
    const Vec3 &a0 = vertices[edges.tail(h)], &a1 = vertices[edges.head(h)];
    for (std::size_t j = 0; j < path.size(); ++j) {
      const std::size_t k = j + 1 == path.size() ? 0 : j + 1;
      if (edges.edge(path[j]) == used[i]) {
        const double turn = outerAngle(vertices, edges, h) / (2 * kPi);
        sum += path[j] == h ? turn : -turn;
      } else if (edges.edge(path[k]) != used[i]) {
        sum += gaussIntegral(a0, a1, middle[j], middle[k]);
      }
    }
  }
  return sum;
}

}  // namespace

double gaussIntegral(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) {
  const Vec3 p = a0 - b0, q = a1 - b0, r = a1 - b1, s = a0 - b1;
  // Both triangles of the quadrilateral p q r s have angles below a full turn together.
  return std::arg(halfAngle(p, r, q) * halfAngle(p, s, r)) / (2 * kPi);
}

LinkingNumbers linkingNumbers(const Points& vertices, const HalfEdges& edges,
                              const std::vector<Loop>& loops) {
  const std::size_t n = loops.size();
  std::vector<std::vector<int>> paths;
  for (const Loop& loop : loops) paths.push_back(leftPath(edges, loop));
  std::vector<double> integral(n * n);
  const auto body = [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      integral[k] = linkingIntegral(vertices, edges, loops[k / n], paths[k % n]);
  };
  parallelBlocks(n * n, 1, body, "telling what bounds inside");
  LinkingNumbers out{IntegerMatrix(n, Integers(n, 0)), 0};
  for (std::size_t k = 0; k < n * n; ++k) {
    if (!std::isfinite(integral[k])) {
      out.residual = 1;
      continue;
    }
    out.matrix[k / n][k % n] = std::llround(integral[k]);
    out.residual = std::max(out.residual, std::abs(integral[k] - std::round(integral[k])));
  }
  return out;
}

}  // namespace innermap
