#include "surface/detail/sphere/star_kernel.h"

#include <algorithm>
#include <cmath>

namespace innermap {
namespace {

struct Point2 {
  double x, y;
};

// Clips a convex polygon to a + b x + c y >= 0.
void clip(std::vector<Point2>& polygon, double a, double b, double c) {
  std::vector<Point2> out;
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Point2 &p = polygon[i], &q = polygon[(i + 1) % n];
    const double dp = a + b * p.x + c * p.y, dq = a + b * q.x + c * q.y;
    if (dp >= 0) out.push_back(p);
    if ((dp >= 0) != (dq >= 0)) {
      const double s = dp / (dp - dq);
      out.push_back({p.x + s * (q.x - p.x), p.y + s * (q.y - p.y)});
    }
  }
  polygon.swap(out);
}

bool centroid(const std::vector<Point2>& polygon, Point2& out) {
  double area = 0;
  Point2 sum{0, 0};
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const Point2 &o = polygon[0], &p = polygon[i], &q = polygon[i + 1];
    const double a = (p.x - o.x) * (q.y - o.y) - (p.y - o.y) * (q.x - o.x);
    area += a;
    sum.x += a * (o.x + p.x + q.x) / 3;
    sum.y += a * (o.y + p.y + q.y) / 3;
  }
  if (!(area > 0)) return false;
  out = {sum.x / area, sum.y / area};
  return true;
}

}  // namespace

void ringPlaces(const Layout& layout, const Ring& ring, RingPlaces& out) {
  out.clear();
  for (const RingVertex& r : ring)
    out.push_back(layout.shift.empty() ? layout.place[r.vertex]
                                       : layout.moved(layout.place[r.vertex], r.shift));
}

Tangent tangentAt(ModelSpace space, const Vec3& p) {
  if (space == ModelSpace::torus) return {{1, 0, 0}, {0, 1, 0}};
  const int axis = std::abs(p.x) < 0.6 ? 0 : std::abs(p.y) < 0.6 ? 1 : 2;
  Vec3 e;
  e[axis] = 1;
  Vec3 u = cross(p, e);
  u = u / norm(u);
  return {u, cross(p, u)};
}

bool starIsValid(const Vec3& p, const RingPlaces& ring) {
  const std::size_t n = ring.size();
  for (std::size_t i = 0; i < n; ++i)
    if (!(tripleProduct(p, ring[i], ring[i + 1 == n ? 0 : i + 1]) > 0)) return false;
  return true;
}

bool placeNear(ModelSpace space, const RingPlaces& ring, std::size_t w, Vec3& place) {
  const std::size_t n = ring.size();
  const Vec3 &at = ring[w], &after = ring[(w + 1) % n], &before = ring[(w + n - 1) % n];
  // Left of both edges of the ring that meet at w; the fan takes care of the others.
  const Vec3 up = space == ModelSpace::sphere ? at : Vec3{0, 0, 1};
  const Vec3 left = cross(up, after - at), right = cross(up, at - before);
  const double leftLength = norm(left), rightLength = norm(right);
  if (!(leftLength > 0) || !(rightLength > 0)) return false;
  Vec3 direction = left / leftLength + right / rightLength;
  const double length = norm(direction);
  if (!(length > 1e-12)) return false;
  direction = direction / length;
  for (double step = 0.5 * std::min(leftLength, rightLength); step > 1e-15; step *= 0.5) {
    place = moveAlong(space, at, step * direction);
    if (starIsValid(place, ring)) return true;
  }
  return false;
}

Vec3 kernelCentroid(ModelSpace space, const Vec3& p, const RingPlaces& ring) {
  const Tangent tangent = tangentAt(space, p);
  const double far = space == ModelSpace::sphere ? 20 : 1e3;
  thread_local std::vector<Point2> polygon;
  polygon = {{-far, -far}, {far, -far}, {far, far}, {-far, far}};
  const std::size_t n = ring.size();
  for (std::size_t i = 0; i < n && polygon.size() > 2; ++i) {
    const Vec3 &a = ring[i], &b = ring[i + 1 == n ? 0 : i + 1];
    const Vec3 side = cross(a, b - a);
    const double length = norm(side);
    if (!(length > 0)) return p;
    clip(polygon, dot(p - a, side) / length, dot(tangent.u, side) / length,
         dot(tangent.v, side) / length);
  }
  Point2 c;
  if (!centroid(polygon, c)) return p;
  const Vec3 place = moveAlong(space, p, c.x * tangent.u + c.y * tangent.v);
  return starIsValid(place, ring) ? place : p;
}

}  // namespace innermap
