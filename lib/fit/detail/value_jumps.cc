#include "fit/detail/value_jumps.h"

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

std::vector<ValueJump> valueJumps(const Solid& solid, const Points& values, double least) {
  if (!solid.overlaps()) return {};
  const Mesh& mesh = solid.repaired().mesh;
  const std::vector<Crossing> crossings = selfIntersections(mesh.vertices, mesh.triangles);
  std::vector<std::vector<ValueJump>> found(crossings.size());
  const double apart = kApart * solid.diagonal(),
               exposed = solid.gap() + kExposed * solid.diagonal();
  parallelBlocks(
      crossings.size(), 64,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
          std::array<Corners, 2> at, value;
          for (int side = 0; side < 2; ++side)
            for (int k = 0; k < 3; ++k) {
              const int v = mesh.triangles[side ? crossings[c].second : crossings[c].first][k];
              at[side][k] = mesh.vertices[v];
              value[side][k] = values[v];
            }
          const auto [from, to] = lineOf(at[0], at[1], crossings[c].place);
          const auto count = static_cast<int>(1 + std::min(kMostPlaces, norm(to - from) / apart));
          for (int i = 0; i < count; ++i) {
            const Vec3 p = from + (i + 0.5) / count * (to - from);
            Vec3 difference;
            for (int side = 0; side < 2; ++side) {
              const Vec3 w = barycentric(at[side], p);
              for (int k = 0; k < 3; ++k) difference += (side ? -w[k] : w[k]) * value[side][k];
            }
            if (norm(difference) > least && solid.closest(p, exposed).onSurface.triangle >= 0)
              found[c].push_back({p, norm(difference)});
          }
        }
      },
      "looking for parts that slide along each other");
  std::vector<ValueJump> out;
  for (const std::vector<ValueJump>& part : found) out.insert(out.end(), part.begin(), part.end());
  return out;
}

}  // namespace innermap
