#include "fit/detail/value_jumps.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "innermap/core/run.h"
#include "innermap/mesh/check.h"

namespace innermap {
namespace {

constexpr double kApart = 1.0 / 500, kExposed = 1e-6;  // of the diagonal
constexpr double kMostPlaces = 1000;                   // of one pair of triangles

using Corners = std::array<Vec3, 3>;

Vec3 barycentric(const Corners& t, const Vec3& p) {
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  const double area = squaredNorm(n);
  Vec3 out;
  for (int k = 0; k < 3; ++k)
    out[k] = dot(n, cross(t[(k + 2) % 3] - t[(k + 1) % 3], p - t[(k + 1) % 3])) / area;
  return out;
}

// Appends where the edges of `a` pass through `b`.
void addPiercings(const Corners& a, const Corners& b, Points& out) {
  const Vec3 n = cross(b[1] - b[0], b[2] - b[0]);
  for (int k = 0; k < 3; ++k) {
    const Vec3 &p = a[k], &q = a[(k + 1) % 3];
    const double before = dot(n, p - b[0]), after = dot(n, q - b[0]);
    if (before * after > 0 || before == after) continue;
    const Vec3 at = p + before / (before - after) * (q - p), w = barycentric(b, at);
    if (std::min({w.x, w.y, w.z}) >= 0) out.push_back(at);
  }
}

// Both ends of the line that two triangles share; twice its middle where they cannot be told.
std::array<Vec3, 2> lineOf(const Corners& a, const Corners& b, const Vec3& middle) {
  Points found;
  addPiercings(a, b, found);
  addPiercings(b, a, found);
  std::array<Vec3, 2> out{middle, middle};
  double longest = 0;
  for (const Vec3& p : found)
    for (const Vec3& q : found)
      if (norm(q - p) > longest) {
        longest = norm(q - p);
        out = {p, q};
      }
  return out;
}

}  // namespace

CrossingLines::CrossingLines(const Solid& solid) {
  if (!solid.overlaps()) return;
  const Mesh& mesh = solid.repaired().mesh;
  const std::vector<Crossing> crossings = selfIntersections(mesh.vertices, mesh.triangles);
  const double apart = kApart * solid.diagonal(),
               exposed = solid.gap() + kExposed * solid.diagonal();
  std::vector<Points> found(crossings.size());
  const auto cornersOf = [&](int triangle) {
    Corners out;
    for (int k = 0; k < 3; ++k) out[k] = mesh.vertices[mesh.triangles[triangle][k]];
    return out;
  };
  parallelBlocks(
      crossings.size(), 64,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
          const auto [from, to] = lineOf(cornersOf(crossings[c].first),
                                         cornersOf(crossings[c].second), crossings[c].place);
          const auto count = static_cast<int>(1 + std::min(kMostPlaces, norm(to - from) / apart));
          for (int i = 0; i < count; ++i) {
            const Vec3 p = from + (i + 0.5) / count * (to - from);
            if (solid.closest(p, exposed).onSurface.triangle >= 0) found[c].push_back(p);
          }
        }
      },
      "looking for sliding parts");
  for (std::size_t c = 0; c < crossings.size(); ++c)
    for (const Vec3& p : found[c]) {
      places_.push_back(p);
      for (int side = 0; side < 2; ++side) {
        const int triangle = side ? crossings[c].second : crossings[c].first;
        const Vec3 w = barycentric(cornersOf(triangle), p);
        sides_[side].push_back({triangle, {w.x, w.y, w.z}});
      }
    }
}

std::vector<ValueJump> CrossingLines::jumps(const Values& values, double least) const {
  std::vector<ValueJump> out;
  if (places_.empty()) return out;
  const Matrix first = values(sides_[0]), second = values(sides_[1]);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    double squared = 0;
    for (std::size_t k = 0; k < first.columns(); ++k)
      squared += (first(i, k) - second(i, k)) * (first(i, k) - second(i, k));
    if (std::sqrt(squared) > least) out.push_back({places_[i], std::sqrt(squared)});
  }
  return out;
}

std::vector<ValueJump> CrossingLines::jumps(const Solid& solid, const Points& values,
                                            double least) const {
  const Mesh& mesh = solid.repaired().mesh;
  return jumps(
      [&](const std::vector<SurfacePoint>& addresses) {
        Matrix out(addresses.size(), 3);
        for (std::size_t i = 0; i < addresses.size(); ++i) {
          Vec3 sum;
          for (int k = 0; k < 3; ++k)
            sum += addresses[i].barycentric[k] * values[mesh.triangles[addresses[i].triangle][k]];
          for (int k = 0; k < 3; ++k) out(i, k) = sum[k];
        }
        return out;
      },
      least);
}

std::string jumpsText(const std::vector<ValueJump>& jumps, double unit,
                      const std::string& unitName) {
  if (jumps.empty()) return "";
  const ValueJump& worst =
      *std::max_element(jumps.begin(), jumps.end(),
                        [](const ValueJump& a, const ValueJump& b) { return a.size < b.size; });
  return fmt::format(
      "where exposed parts cross, their values differ by up to {:.2g} of {}, most near ({:.4g}, "
      "{:.4g}, {:.4g}); the fit blends there, and its error is large along those lines",
      worst.size / unit, unitName, worst.place.x, worst.place.y, worst.place.z);
}

}  // namespace innermap
