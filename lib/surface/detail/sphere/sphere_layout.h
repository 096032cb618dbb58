// A closed surface of genus 0 laid out on the unit sphere.
#pragma once

#include "innermap/surface/correspond.h"

namespace innermap {

// One-to-one: every triangle has a positive tripleProduct, and areas are kept near their share (no
// shrinking of limbs, as conformal maps have it). The surface is coarsened to a tetrahedron, whose
// vertices then return one by one on the sphere, where the symmetric Dirichlet energy of the
// triangles, with tripleProduct as its barrier, is lowered around them: Praun and Hoppe, "Spherical
// parametrization and remeshing" (SIGGRAPH 2003); Hu, Fu, Liu, "Advanced hierarchical spherical
// parameterizations" (TVCG 2018). Slivers are given some area (rest_triangle.h).
//
// Deterministic. Throws DataError when the surface is not of genus 0, or so degenerate that
// rounding leaves no valid place for a vertex; Cancelled.
Layout layOutSphere(const ClosedSurface& surface);

}  // namespace innermap
