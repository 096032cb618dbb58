// Linking numbers of loops on a surface with loops pushed off it.
#pragma once

#include "innermap/core/vec3.h"
#include "surface/detail/topology/half_edges.h"
#include "surface/detail/topology/homology.h"

namespace innermap {

// Gauss's linking integral of two segments: the solid angle of all directions from one to the
// other over 4 pi, signed. Exact (Bertolazzi, Ghiloni, Specogna, "Efficient computation of linking
// number with certification", 2019); 0 of segments in one plane.
double gaussIntegral(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1);

// Linking numbers of loop i with loop j pushed off the surface to its outside, for all pairs, and
// how far the integrals were from integers.
//
// Nothing is moved by a small distance: loop j is replaced by the path through the midpoints of the
// edges to its left, which stays on the surface. Where it crosses an edge of loop i, the limit of
// the integral for paths ever nearer to the surface is the angle between the edge's triangles on
// the outside over 2 pi; all other pairs of segments have integrals of their own.
struct LinkingNumbers {
  IntegerMatrix matrix;
  double residual = 0;
};
LinkingNumbers linkingNumbers(const Points& vertices, const HalfEdges& edges,
                              const std::vector<Loop>& loops);

}  // namespace innermap
