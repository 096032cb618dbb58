// Pairs of boundaries with a map inside that is known.
#pragma once

#include <cmath>
#include <functional>

#include "innermap/fit/boundary_pair.h"
#include "mesh/shapes.h"

namespace innermap {

inline Mesh moved(const Mesh& mesh, const std::function<Vec3(const Vec3&)>& map) {
  Mesh out = mesh;
  for (Vec3& p : out.vertices) p = map(p);
  out.name = "target";
  return out;
}

inline Mesh ball(int levels = 3) {
  Mesh mesh = shapes::icosphere(levels);
  mesh.name = "ball";
  return mesh;
}

// Of radius 1, their middles `apart` to either side of the origin along x: one mesh whatever that
// is, which runs through itself below 1.
inline Mesh twoBalls(double apart) {
  Mesh mesh = shapes::joined(shapes::icosphere(3, 1, {-apart, 0, 0}),
                             shapes::icosphere(3, 1, {apart, 0, 0}));
  mesh.name = "two balls";
  return mesh;
}

struct Limb {
  double width = 0.3;
  double head = 0;  // by how much its end is wider than its neck, as a share of it
};

// A ball whose skin at one pole is drawn out so far, or in, below 0.
inline Mesh drawnOut(double by, const Limb& limb = {}) {
  return moved(ball(4), [&](const Vec3& p) {
    if (p.z <= 0) return p;
    const double near = std::exp(-std::pow(std::hypot(p.x, p.y) / limb.width, 4));
    const double wider = 1 + limb.head * near * near;
    return Vec3{wider * p.x, wider * p.y, p.z + by * near};
  });
}

inline constexpr Mat3 kAffine = {{{2, 0.5, 0}, {0, 1, -0.25}, {0.125, 0, 1.5}}};
inline constexpr Vec3 kAffineShift = {1, 0, -2};
inline Vec3 affineMap(const Vec3& p) { return kAffine * p + kAffineShift; }

// Each component is harmonic, the map one-to-one on the unit ball.
inline Vec3 harmonicPolynomial(const Vec3& p) {
  return {p.x + 0.1 * (p.x * p.x - p.y * p.y), p.y + 0.1 * p.x * p.z, p.z + 0.05 * p.x * p.y};
}

}  // namespace innermap
