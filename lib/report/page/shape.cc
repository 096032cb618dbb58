#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>

#include "report/page/page.h"

namespace innermap {
namespace {

// A page holds some millions of positions; more is too large to load at once.
constexpr std::size_t kMostVertices = 60'000, kMostPositions = 900'000, kLeastVertices = 2'000;

// For each vertex the one that stands for its cell of a lattice of this spacing: the first in it.
std::vector<int> representatives(const Points& points, const Box3& box, double spacing) {
  std::unordered_map<std::uint64_t, int> first;
  std::vector<int> out(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::uint64_t key = 0;
    for (int a = 0; a < 3; ++a) {
      const double cell = (points[i][a] - box.lower[a]) / spacing;
      key = (key << 21) | static_cast<std::uint64_t>(std::clamp(cell, 0.0, 2e6));
    }
    out[i] = first.emplace(key, static_cast<int>(i)).first->second;
  }
  return out;
}

std::size_t countOwn(const std::vector<int>& of) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < of.size(); ++i) count += of[i] == static_cast<int>(i);
  return count;
}

// Indices of the vertices that stay.
std::vector<int> merge(PageShape& shape, const std::vector<int>& of) {
  std::vector<int> kept, place(of.size(), -1);
  Points points;
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (of[i] != static_cast<int>(i)) continue;
    place[i] = static_cast<int>(kept.size());
    kept.push_back(static_cast<int>(i));
    points.push_back(shape.places.front().points[i]);
  }
  shape.places.front().points = std::move(points);
  std::vector<Triangle> triangles;
  for (const Triangle& t : shape.triangles) {
    Triangle n;
    for (int k = 0; k < 3; ++k)
      n[k] = place[static_cast<std::size_t>(of[static_cast<std::size_t>(t[k])])];
    if (n[0] != n[1] && n[1] != n[2] && n[2] != n[0]) triangles.push_back(n);
  }
  shape.triangles = std::move(triangles);
  return kept;
}

// The larger singular value of the linear map between two triangles, by the edges' Gram matrices.
double largestStretch(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const double e = dot(a, a), f = dot(a, b), g = dot(b, b), area = e * g - f * f;
  if (!(area > 0)) return std::nan("");
  const double h = dot(c, c), i = dot(c, d), j = dot(d, d);
  // Trace and determinant of inverse(Gram of the first) * (Gram of the second).
  const double half = (g * h - 2 * f * i + e * j) / (2 * area), det = (h * j - i * i) / area;
  return std::sqrt(half + std::sqrt(std::max(0.0, half * half - det)));
}

}  // namespace

std::size_t verticesForPlaces(std::size_t places) {
  return std::max(kLeastVertices,
                  std::min(kMostVertices, kMostPositions / std::max<std::size_t>(1, places)));
}

std::vector<int> simplify(PageShape& shape, std::size_t mostVertices) {
  const Points& points = shape.places.front().points;
  Box3 box;
  for (const Vec3& p : points)
    if (isFinite(p)) box.add(p);
  std::vector<int> of(points.size());
  std::iota(of.begin(), of.end(), 0);
  if (points.size() <= mostVertices || !(box.diagonal() > 0)) return of;
  shape.givenVertices = points.size();
  // A surface: as many cells as its diagonal has, squared, about.
  double spacing = box.diagonal() / std::sqrt(static_cast<double>(mostVertices));
  of = representatives(points, box, spacing);
  while (countOwn(of) > mostVertices) of = representatives(points, box, spacing *= 1.15);
  return merge(shape, of);
}

std::vector<double> stretches(const Points& from, const Points& to,
                              const std::vector<Triangle>& triangles) {
  std::vector<double> sum(from.size(), 0.0), weight(from.size(), 0.0);
  for (const Triangle& t : triangles) {
    const auto [i, j, k] = t;
    const Vec3 a = from[j] - from[i], b = from[k] - from[i];
    const double s = largestStretch(a, b, to[j] - to[i], to[k] - to[i]);
    if (!std::isfinite(s)) continue;
    const double area = norm(cross(a, b));
    for (const int v : t) {
      sum[static_cast<std::size_t>(v)] += area * s;
      weight[static_cast<std::size_t>(v)] += area;
    }
  }
  for (std::size_t v = 0; v < sum.size(); ++v)
    sum[v] = weight[v] > 0 ? sum[v] / weight[v] : std::nan("");
  return sum;
}

}  // namespace innermap
