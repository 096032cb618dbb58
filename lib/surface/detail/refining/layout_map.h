// The map between two surfaces through their layouts on one model space, with
// its derivative: piecewise projective, exact, not the chords between the moved vertices.
#pragma once

#include <array>
#include <cmath>

#include "innermap/surface/correspond.h"
#include "surface/detail/refining/locate.h"

namespace innermap {

// Singular values of a Jacobian, s1 >= s2 >= 0.
struct Stretches {
  double s1 = 0, s2 = 0;

  double worst() const { return std::max(s1, 1 / s2); }
  double symmetricDirichlet() const { return s1 * s1 + s2 * s2 + 1 / (s1 * s1) + 1 / (s2 * s2); }
};

// From the images of two orthonormal directions.
inline Stretches stretchesOf(const Vec3& x, const Vec3& y) {
  const double trace = dot(x, x) + dot(y, y), det = norm(cross(x, y));
  // As half the sum and half the difference of s1 + s2 and s1 - s2: exact where both are equal.
  const double sum = std::sqrt(trace + 2 * det),
               difference = std::sqrt(std::max(0.0, trace - 2 * det));
  const double s1 = 0.5 * (sum + difference);
  return {s1, s1 > 0 ? det / s1 : 0};
}

// A triangle laid flat: corners (0, 0), (length, 0), (x, y). Barycentric coordinates change by
// `along[0]` for a unit step along the first edge and by `along[1]` across it.
struct FlatTriangle {
  std::array<std::array<double, 3>, 2> along{};
  double area = 0;
  bool sliver = true;  // a height under a millionth of the longest edge: derivatives mean nothing

  FlatTriangle(const Vec3& a, const Vec3& b, const Vec3& c);
};

// A surface with its layout and what finds places in it.
struct LaidOut {
  const ClosedSurface& surface;
  const Layout& layout;
  const Locator& locator;

  // The ray, or point of the plane, of a place in a triangle.
  Vec3 ray(int triangle, const std::array<double, 3>& barycentric) const {
    Vec3 sum;
    for (int k = 0; k < 3; ++k)
      sum += barycentric[k] * layout.corner(surface.triangles, triangle, k);
    return sum;
  }
};

// What `a` and `b` refer to must outlive it. Immutable; safe from any number of threads.
class LayoutMap {
 public:
  LayoutMap(const LaidOut& a, const LaidOut& b) : a_(a), b_(b) {}

  struct Image {
    int triangle = -1;  // of B
    std::array<double, 3> barycentric{};
    Vec3 position;
    bool measured = false;  // false on slivers of A or B
    Stretches stretches;    // of the map A -> B there
  };
  // Of a point of A.
  Image at(int triangle, const std::array<double, 3>& barycentric) const;

  struct Preimage {
    int triangle = -1;  // of A
    Vec3 position;
    bool measured = false;
    Stretches stretches;  // of the map A -> B there
  };
  // Of a point of B.
  Preimage of(int triangle, const std::array<double, 3>& barycentric) const;
  // Its position alone.
  Vec3 preimage(int triangle, const std::array<double, 3>& barycentric) const;

 private:
  // ray: a mean of the corners of A's triangle (weights of sum 1), in the frame of B's.
  bool derivative(int triangleA, int triangleB, const Vec3& ray, Stretches& out) const;

  Located find(const LaidOut& on, const Vec3& ray) const;

  LaidOut a_, b_;
};

}  // namespace innermap
