// Shapes between two surfaces, smoothed so that they do not run through themselves.
#pragma once

#include <memory>
#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

// The cotangent of the angle at `c` in the triangle a, b, c; of slivers what is nearest to it among
// the weights that keep a sum over edges well posed.
double edgeWeight(const Vec3& a, const Vec3& b, const Vec3& c);

// Takes a shape y to y + s (S y - y), with S = (M + lambda K)^-1 M: K the cotangent Laplacian and M
// the area of each vertex, both averaged over the two surfaces, each of area 1 (Desbrun, Meyer,
// Schroeder and Barr, "Implicit fairing", SIGGRAPH 1999). As neither metric is that of the shape in
// between, limbs and pits of either surface shrink in length and width together and are not pinched
// off: Kazhdan, Solomon and Ben-Chen, "Can mean-curvature flow be modified to be non-singular?"
// (SGP 2012). y + s (S y - y) takes all scales alike, so that detail does not go at once.
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
