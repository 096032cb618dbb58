// A closed surface of genus 1 laid out on the plane modulo a lattice.
#pragma once

#include "innermap/surface/correspond.h"

namespace innermap {

// One-to-one: every triangle is positive. period[0] is the translation along loops that bound a
// disc inside the solid (meridians), along x; period[1] that along loops that cross those once from
// right to left, the shortest such vector; the lattice's cell has the area 4 pi, the unit sphere's.
// Between two surfaces so laid out, a map that sends period[0] to plus or minus itself extends to
// the solids.
//
// The surface is coarsened; a harmonic map with equal weights lays that out one-to-one (Gortler,
// Gotsman, Thurston, "Discrete one-forms on meshes and applications to 3D mesh parameterization",
// CAGD 2006); the vertices then return one by one, the triangles' symmetric Dirichlet energy being
// lowered around them and the lattice's shape with it. Limbs so keep their area, which a harmonic
// map of the whole surface shrinks below rounding.
//
// Deterministic. Throws DataError when the surface is not of genus 1, when no loop around its
// handle bounds a disc inside the solid (a tunnel that is knotted), or when it passes through
// itself so that this cannot be told; Cancelled.
Layout layOutTorus(const ClosedSurface& surface);

// Brings the places of all vertices into one cell of the lattice; the first corners' shifts are 0
// then. The map stays what it is.
void moveIntoCell(const std::vector<Triangle>& triangles, Layout& layout);

// The points where a straight line along period[0] crosses the edges of a layout on the torus, on
// the surface: a simple closed polygon, a meridian. Of several lines the shortest.
Points meridianCurve(const ClosedSurface& surface, const Layout& layout);

}  // namespace innermap
