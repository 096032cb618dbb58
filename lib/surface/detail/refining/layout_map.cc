#include "surface/detail/refining/layout_map.h"

#include <algorithm>

namespace innermap {
namespace {

constexpr double kSliver = 1e-6;  // height over longest edge

Vec3 mean(const Vec3* corners, const std::array<double, 3>& weights) {
  return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
}

std::array<Vec3, 3> cornersOf(const ClosedSurface& surface, int triangle) {
  const Triangle& t = surface.triangles[triangle];
  return {surface.vertices[t[0]], surface.vertices[t[1]], surface.vertices[t[2]]};
}

}  // namespace

FlatTriangle::FlatTriangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  const double length = norm(ab), twiceArea = norm(cross(ab, ac));
  const double longest = std::max({length, norm(ac), norm(c - b)});
  area = 0.5 * twiceArea;
  sliver = !(twiceArea > kSliver * longest * longest);
  if (sliver) return;
  const double x = dot(ac, ab) / length, y = twiceArea / length;
  along[0] = {-1 / length, 1 / length, 0};
  along[1] = {(x / length - 1) / y, -x / (length * y), 1 / y};
}

bool LayoutMap::derivative(int triangleA, int triangleB, const Vec3& ray, Stretches& out) const {
  const auto a = cornersOf(a_.surface, triangleA), b = cornersOf(b_.surface, triangleB);
  const FlatTriangle flat(a[0], a[1], a[2]);
  if (flat.sliver || FlatTriangle(b[0], b[1], b[2]).sliver) return false;
  const Locator::Cone& to = b_.locator.cone(triangleB);
  const std::array<double, 3> weights = to.weights(ray);
  const double sum = weights[0] + weights[1] + weights[2];
  std::array<Vec3, 2> moved;
  for (int d = 0; d < 2; ++d) {
    const Vec3 step = a_.ray(triangleA, flat.along[d]);
    std::array<double, 3> change;
    for (int k = 0; k < 3; ++k) change[k] = dot(step, to.side[k]);
    const double total = change[0] + change[1] + change[2];
    for (int k = 0; k < 3; ++k) change[k] = (change[k] - weights[k] / sum * total) / sum;
    moved[d] = change[1] * (b[1] - b[0]) + change[2] * (b[2] - b[0]);
  }
  out = stretchesOf(moved[0], moved[1]);
  return out.s2 > 0 && std::isfinite(out.s1);
}

Located LayoutMap::find(const LaidOut& on, const Vec3& ray) const {
  return on.locator.find(on.layout.space == ModelSpace::sphere ? ray / norm(ray) : ray);
}

LayoutMap::Image LayoutMap::at(int triangle, const std::array<double, 3>& barycentric) const {
  const Vec3 ray = a_.ray(triangle, barycentric);
  const Located where = find(b_, ray);
  Image image;
  image.triangle = where.triangle;
  image.barycentric = b_.locator.barycentric(ray, where);
  image.position = mean(cornersOf(b_.surface, where.triangle).data(), image.barycentric);
  image.measured =
      derivative(triangle, where.triangle, b_.locator.local(ray, where), image.stretches);
  return image;
}

Vec3 LayoutMap::preimage(int triangle, const std::array<double, 3>& barycentric) const {
  const Vec3 ray = b_.ray(triangle, barycentric);
  const Located where = find(a_, ray);
  return mean(cornersOf(a_.surface, where.triangle).data(), a_.locator.barycentric(ray, where));
}

LayoutMap::Preimage LayoutMap::of(int triangle, const std::array<double, 3>& barycentric) const {
  Vec3 ray = b_.ray(triangle, barycentric);
  const Located where = find(a_, ray);
  const std::array<double, 3> onA = a_.locator.barycentric(ray, where);
  Preimage preimage;
  preimage.triangle = where.triangle;
  preimage.position = mean(cornersOf(a_.surface, where.triangle).data(), onA);
  // On the sphere rays may have any length; the derivative wants that of A's chord.
  if (a_.layout.space == ModelSpace::sphere) ray = a_.ray(where.triangle, onA);
  preimage.measured = derivative(where.triangle, triangle, ray, preimage.stretches);
  return preimage;
}

}  // namespace innermap
