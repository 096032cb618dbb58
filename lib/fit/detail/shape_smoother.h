// Shapes between two surfaces, smoothed so that they do not run through themselves.
#pragma once

#include <memory>
#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

// Takes the positions of a shape along the heat flow of a fixed metric: y becomes exp(-tau L) y,
// with L the Laplacian (cotangents) and tau growing from 0 at both ends of the way to its most half
// way.
//
// The metric of one closed surface without handles is the sphere's, on which it is laid out by area
// (EmbeddedSurface): the flow damps the spherical harmonics of degree l by exp(-l (l + 1) tau /
// r^2), as in Chung, Dalton, Shen, Evans and Davidson, "Weighted Fourier series representation and
// its application to quantifying the amount of gray matter", IEEE Transactions on Medical Imaging
// 26 (2007). In the limit degree 1 is left, the sphere under a linear map. On the way each
// limb and pit draws back along itself and widens as far as it has room by its area. In a metric
// of the surface's own, limbs are long tubes: their ends become exponentially small, with their
// folds in them (Kazhdan, Solomon and Ben-Chen, "Can mean-curvature flow be modified to be
// non-singular?", SGP 2012). Other surfaces have no better one here: theirs is the mean of the two,
// and they go less far.
class ShapeSmoother {
 public:
  // from, to: positions of the vertices of `triangles`. Throws DataError if both have no area.
  ShapeSmoother(const Points& from, const Points& to, const std::vector<Triangle>& triangles);
  ~ShapeSmoother();
  ShapeSmoother(ShapeSmoother&&) noexcept;

  // The shape at t in (0, 1) of the way between them, with its volume as `from` has it.
  // Not by two threads at once.
  Points smoothed(const Points& shape, double t) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace innermap
