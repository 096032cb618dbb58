#include "mesh/detail/intersect_triangles.h"

#include <algorithm>
#include <cmath>

namespace innermap {
namespace {

constexpr double kEpsilon = 0x1.0p-53;
// Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates"
// (1997), bounds A.
constexpr double kBound3 = (7 + 56 * kEpsilon) * kEpsilon;
constexpr double kBound2 = (3 + 16 * kEpsilon) * kEpsilon;
// Intersections shorter than this share of the longer interval are touching.
constexpr double kTouch = 1e-9;

// Six times the volume of tetrahedron t, p, up to sign; 0 where its sign is not certain.
double side(const TriangleCorners& t, const Vec3& p) {
  const Vec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
  const double xy[3] = {b.x * c.y, c.x * a.y, a.x * b.y};
  const double yx[3] = {c.x * b.y, a.x * c.y, b.x * a.y};
  const double determinant = a.z * (xy[0] - yx[0]) + b.z * (xy[1] - yx[1]) + c.z * (xy[2] - yx[2]);
  const double permanent = std::abs(a.z) * (std::abs(xy[0]) + std::abs(yx[0])) +
                           std::abs(b.z) * (std::abs(xy[1]) + std::abs(yx[1])) +
                           std::abs(c.z) * (std::abs(xy[2]) + std::abs(yx[2]));
  return std::abs(determinant) > kBound3 * permanent ? determinant : 0;
}

struct Sides {
  double value[3];
  bool positive = false, negative = false;

  bool apart() const { return positive != negative; }  // all on one side, but for touching
  bool coplanar() const { return !positive && !negative; }
};

Sides sidesOf(const TriangleCorners& plane, const TriangleCorners& t, const bool* shared) {
  Sides sides;
  for (int k = 0; k < 3; ++k) {
    sides.value[k] = shared[k] ? 0 : side(plane, t[k]);
    sides.positive = sides.positive || sides.value[k] > 0;
    sides.negative = sides.negative || sides.value[k] < 0;
  }
  return sides;
}

// Where a triangle meets the other's plane: two points, and their parameters along the line.
struct Interval {
  Vec3 point[2];
  double low = 0, high = 0;
};

Interval intervalOf(const TriangleCorners& t, const Sides& sides, const Vec3& origin,
                    const Vec3& direction) {
  Interval interval;
  int found = 0;
  for (int k = 0; k < 3 && found < 2; ++k) {
    const int next = (k + 1) % 3;
    const double a = sides.value[k], b = sides.value[next];
    if (a == 0)
      interval.point[found++] = t[k];
    else if (b != 0 && (a > 0) != (b > 0))
      interval.point[found++] = t[k] + (a / (a - b)) * (t[next] - t[k]);
  }
  interval.low = dot(interval.point[0] - origin, direction);
  interval.high = dot(interval.point[1] - origin, direction);
  if (interval.low > interval.high) {
    std::swap(interval.low, interval.high);
    std::swap(interval.point[0], interval.point[1]);
  }
  return interval;
}

bool crossing(const TriangleCorners& a, const Sides& sidesA, const TriangleCorners& b,
              const Sides& sidesB, Vec3& place) {
  const Vec3 direction = cross(cross(a[1] - a[0], a[2] - a[0]), cross(b[1] - b[0], b[2] - b[0]));
  const Interval ia = intervalOf(a, sidesA, a[0], direction);
  const Interval ib = intervalOf(b, sidesB, a[0], direction);
  const double low = std::max(ia.low, ib.low), high = std::min(ia.high, ib.high);
  if (!(high - low > kTouch * std::max(ia.high - ia.low, ib.high - ib.low))) return false;
  place = 0.5 * ((ia.low > ib.low ? ia : ib).point[0] + (ia.high < ib.high ? ia : ib).point[1]);
  return true;
}

using FlatTriangle = std::array<Vec2, 3>;

// Twice the signed area; 0 where its sign is not certain.
double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
  const double area = left - right;
  return std::abs(area) > kBound2 * (std::abs(left) + std::abs(right)) ? area : 0;
}

// Whether a side of `a` has all of `b` on its other side.
bool separates(const FlatTriangle& a, const FlatTriangle& b) {
  for (int k = 0; k < 3; ++k) {
    bool all = true;
    for (const Vec2& p : b) all = all && turn(a[k], a[(k + 1) % 3], p) <= 0;
    if (all) return true;
  }
  return false;
}

bool coplanarOverlap(const TriangleCorners& a, const TriangleCorners& b, Vec3& place) {
  const Vec3 normal = cross(a[1] - a[0], a[2] - a[0]);
  const int drop = std::abs(normal.x) > std::abs(normal.y)
                       ? (std::abs(normal.x) > std::abs(normal.z) ? 0 : 2)
                       : (std::abs(normal.y) > std::abs(normal.z) ? 1 : 2);
  const auto flatten = [drop](const TriangleCorners& t) {
    FlatTriangle flat;
    for (int k = 0; k < 3; ++k) flat[k] = {t[k][(drop + 1) % 3], t[k][(drop + 2) % 3]};
    if (turn(flat[0], flat[1], flat[2]) < 0) std::swap(flat[1], flat[2]);
    return flat;
  };
  const FlatTriangle fa = flatten(a), fb = flatten(b);
  // A triangle without area overlaps nothing.
  if (turn(fa[0], fa[1], fa[2]) == 0 || turn(fb[0], fb[1], fb[2]) == 0) return false;
  if (separates(fa, fb) || separates(fb, fa)) return false;
  place = (a[0] + a[1] + a[2] + b[0] + b[1] + b[2]) / 6;
  return true;
}

}  // namespace

bool passThrough(const TriangleCorners& a, const TriangleCorners& b, Vec3& place) {
  bool sharedA[3] = {}, sharedB[3] = {};
  int shared = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (a[i].x == b[j].x && a[i].y == b[j].y && a[i].z == b[j].z) {
        sharedA[i] = sharedB[j] = true;
        ++shared;
      }
  if (shared >= 3) return false;  // the same triangle, be it turned
  const Sides sidesB = sidesOf(a, b, sharedB);
  if (sidesB.apart()) return false;
  const Sides sidesA = sidesOf(b, a, sharedA);
  if (sidesA.apart()) return false;
  if (sidesA.coplanar() && sidesB.coplanar()) return coplanarOverlap(a, b, place);
  if (sidesA.coplanar() || sidesB.coplanar()) return false;
  return crossing(a, sidesA, b, sidesB, place);
}

}  // namespace innermap
