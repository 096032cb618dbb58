#include "mesh/triangulate.h"

#include <algorithm>
#include <cmath>

#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr int kMostCorners = 2048;  // ear clipping is quadratic
constexpr double kFlat = 1e-10;     // sine under which a corner counts as straight

double cross2(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }
Vec2 minus(const Vec2& a, const Vec2& b) { return {a.x - b.x, a.y - b.y}; }

// Sine of the turn at b, scaled by both lengths, set to zero when it is rounding.
double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 u = minus(b, a), v = minus(c, b);
  const double sine = cross2(u, v);
  return std::abs(sine) <= kFlat * std::hypot(u.x, u.y) * std::hypot(v.x, v.y) ? 0 : sine;
}

// Corners in the mean plane (Newell's normal up), counter-clockwise; empty when the area vanishes.
std::vector<Vec2> project(const Points& vertices, const int* corners, int count) {
  const Vec3 origin = vertices[corners[0]];
  Vec3 normal;
  double longest = 0;
  for (int k = 0; k < count; ++k) {
    const Vec3 a = vertices[corners[k]] - origin;
    const Vec3 b = vertices[corners[(k + 1) % count]] - origin;
    normal += cross(a, b);
    longest = std::max(longest, squaredNorm(a));
  }
  const double length = norm(normal);
  if (!(length > kFlat * longest) || !std::isfinite(length)) return {};
  normal = normal / length;
  const int smallest = std::abs(normal.x) < std::abs(normal.y)
                           ? (std::abs(normal.x) < std::abs(normal.z) ? 0 : 2)
                           : (std::abs(normal.y) < std::abs(normal.z) ? 1 : 2);
  Vec3 axis;
  axis[smallest] = 1;
  const Vec3 u = cross(axis, normal) / norm(cross(axis, normal)), v = cross(normal, u);
  std::vector<Vec2> flat(count);
  for (int k = 0; k < count; ++k) {
    const Vec3 p = vertices[corners[k]] - origin;
    flat[k] = {dot(p, u), dot(p, v)};
  }
  return flat;
}

bool isConvex(const std::vector<Vec2>& flat) {
  const int count = static_cast<int>(flat.size());
  double turning = 0;
  for (int k = 0; k < count; ++k) {
    const Vec2 &a = flat[k], &b = flat[(k + 1) % count], &c = flat[(k + 2) % count];
    if (turn(a, b, c) < 0) return false;
    const Vec2 u = minus(b, a), v = minus(c, b);
    if (count > 4) turning += std::atan2(cross2(u, v), u.x * v.x + u.y * v.y);
  }
  // A star turns left everywhere too, but more than once around.
  return count <= 4 || turning < 9.0;
}

void fan(int count, int apex, std::vector<Triangle>& triangles) {
  triangles.clear();
  for (int k = 1; k + 1 < count; ++k)
    triangles.push_back({apex, (apex + k) % count, (apex + k + 1) % count});
}

class EarClipping {
 public:
  EarClipping(const std::vector<Vec2>& flat, int first) : flat_(flat) {
    const int count = static_cast<int>(flat.size());
    next_.resize(count);
    previous_.resize(count);
    for (int k = 0; k < count; ++k) {
      next_[k] = (k + 1) % count;
      previous_[k] = (k + count - 1) % count;
    }
    current_ = first;
    budget_ = 1000 + 8 * static_cast<long>(count) * count;
  }

  bool run(std::vector<Triangle>& triangles) {
    triangles.clear();
    int left = static_cast<int>(flat_.size());
    while (left > 3) {
      throwIfCancelled();
      if (!advanceToEar(left, false) && !advanceToEar(left, true)) return false;
      if (budget_ < 0) return false;  // made to be slow
      triangles.push_back({previous_[current_], current_, next_[current_]});
      next_[previous_[current_]] = next_[current_];
      previous_[next_[current_]] = previous_[current_];
      // The neighbour's neighbour next: clipping on around spreads the cuts.
      current_ = next_[next_[current_]];
      --left;
    }
    triangles.push_back({previous_[current_], current_, next_[current_]});
    return turn(flat_[previous_[current_]], flat_[current_], flat_[next_[current_]]) >= 0;
  }

 private:
  bool advanceToEar(int left, bool straightToo) {
    for (int k = 0; k < left; ++k, current_ = next_[current_])
      if (isEar(current_, straightToo)) return true;
    return false;
  }

  bool isEar(int corner, bool straightToo) {
    const int before = previous_[corner], after = next_[corner];
    const Vec2 &a = flat_[before], &b = flat_[corner], &c = flat_[after];
    const double sine = turn(a, b, c);
    if (sine < 0 || (sine == 0 && !straightToo)) return false;
    const auto same = [](const Vec2& p, const Vec2& q) { return p.x == q.x && p.y == q.y; };
    for (int k = next_[after]; k != before; k = next_[k]) {
      if (--budget_ < 0) return false;
      const Vec2& p = flat_[k];
      if (same(p, a) || same(p, b) || same(p, c)) continue;  // bridges to holes run twice
      if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
    }
    return true;
  }

  const std::vector<Vec2>& flat_;
  std::vector<int> next_, previous_;
  int current_ = 0;
  long budget_ = 0;  // tests of a point against an ear
};

}  // namespace

void triangulatePolygon(const Points& vertices, const int* corners, int count,
                        std::vector<Triangle>& triangles) {
  if (count == 3) {
    triangles.assign(1, Triangle{0, 1, 2});
    return;
  }
  const int lowest = static_cast<int>(std::min_element(corners, corners + count) - corners);
  if (count <= kMostCorners) {
    const std::vector<Vec2> flat = project(vertices, corners, count);
    if (!flat.empty() && !isConvex(flat) && EarClipping(flat, lowest).run(triangles)) return;
  }
  fan(count, lowest, triangles);
}

}  // namespace innermap
