// The outer surface of a solid whose mesh runs through itself, is open, or has parts that overlap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "innermap/lattice/boundary_topology.h"
#include "innermap/levelset/solid.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

struct OuterSurfaceSettings {
  int resolution = 0;  // cells of the lattice along the longest side of the box, in [8, 1024]; 0:
                       // 80, and more where the solid is thin
  // Of all handles of the surface, at least 0. Without: those that the solid has at three
  // resolutions.
  std::optional<int> handles;
  bool onePiece = false;  // the largest part alone
};

// Where the surface was cut apart: the solid's parts meet there, and would make a handle.
struct SurfaceCut {
  Vec3 place;       // its middle, world units
  double size = 0;  // the diagonal of its box, world units
};

struct OuterSurface {
  Mesh mesh;               // world units; closed, manifold, outward, without self-intersections
  double edge = 0;         // of the lattice's cells, world units
  SolidTopology topology;  // of the mesh
  std::vector<SurfaceCut> cuts;
  std::vector<Box3> caps;  // of the mesh, where it was open; world units
  // Parts of less than a thousandth of the volume of the largest, or all others; and their share of
  // the volume.
  std::size_t leftOut = 0;
  double leftOutShare = 0;
  double insideOut = 0;  // as Solid::insideOut()
  // Of the solid's surface (Solid::surface()) from the mesh, fractions of the diagonal; the cuts
  // are part of the mesh alone.
  double apartP99 = 0, apartMax = 0;
};

// The surface of what the mesh encloses (winding number above 1/2), holes closed, overlaps united,
// with the topology of the mesh instead of the union's: where parts of one body touch or run
// through one another the union has handles that the body has not. The solid is grown again on a
// lattice, node by node from its deepest part, by nodes that change no topology (Bertrand 1994);
// what cannot be taken is a cut. Then as tetrahedralization(): isosurface stuffing, boundary
// vertices on the solid's surface. Sharp edges are cut across. Pockets that are enclosed are
// filled.
//
// Deterministic. Throws SettingError, MemoryError (before allocating), Cancelled; DataError where
// nothing is inside at the resolution, no part of the solid has the handles that are asked for, or
// there are more than 64 that nobody asked for.
OuterSurface outerSurface(const Solid& solid, const OuterSurfaceSettings& settings = {});

}  // namespace innermap
