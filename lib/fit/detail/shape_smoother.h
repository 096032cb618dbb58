// Shapes between two surfaces, smoothed and made rounder so that they do not run through
// themselves.
#pragma once

#include <memory>
#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

// The cotangent of the angle at `c` in the triangle a, b, c; of slivers what is nearest to it among
// the weights that keep a sum over edges well posed.
double edgeWeight(const Vec3& a, const Vec3& b, const Vec3& c);

// Takes a shape y to z = y + s (S y - y), and where the surface is a sphere's, further to
// z + r (b - z), with b the surface as a ball: s is 1 from a quarter of the way on, r half way.
//
// S = (M + lambda K)^-1 M, with K the cotangent Laplacian and M the area of each vertex, both
// averaged over the two surfaces, each of area 1 (Desbrun, Meyer, Schroeder and Barr, "Implicit
// fairing", SIGGRAPH 1999). As neither metric is that of the shape in between, limbs and pits of
// either surface shrink in length and width together and are not pinched off: Kazhdan, Solomon and
// Ben-Chen, "Can mean-curvature flow be modified to be non-singular?" (SGP 2012). y + s (S y - y)
// takes all scales alike, so that detail does not go at once.
//
// S alone leaves the end of a long limb or pit exponentially small, and its folds with it. On the
// ball each part has room by its area (EmbeddedSurface), so limbs and pits spread into cones. The
// ball alone is not enough: the straight way there leads bent limbs through the body.
class ShapeSmoother {
 public:
  // from, to: positions of the vertices of `triangles`. Throws DataError if both have no area.
  ShapeSmoother(const Points& from, const Points& to, const std::vector<Triangle>& triangles);
  ~ShapeSmoother();
  ShapeSmoother(ShapeSmoother&&) noexcept;

  // The shape at t in (0, 1) of the way between them, with its volume as `from` has it.
  Points smoothed(const Points& shape, double t) const;

 private:
  struct Implementation;
  std::unique_ptr<const Implementation> implementation_;
};

}  // namespace innermap
