// The outer surface of a solid whose mesh runs through itself, is open, or has parts that overlap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "innermap/lattice/cell_mesh.h"
#include "innermap/levelset/solid.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

// How many parts, hollows and handles a closed surface has, and whether it is one.

struct SolidTopology {
  int components = 0;  // shells that face outwards
  int cavities = 0;    // shells that face inwards
  int handles = 0;     // of all shells: a torus has one
};
bool operator==(const SolidTopology& a, const SolidTopology& b);
std::string describe(const SolidTopology& topology);  // "1 component, 0 cavities, 2 handles"

struct BoundaryTopology {
  std::size_t openEdges = 0;            // with one triangle
  std::size_t nonManifoldEdges = 0;     // with more than two, or two that run the same way
  std::size_t nonManifoldVertices = 0;  // whose triangles form more than one fan
  // Of shells cut apart where parts touch in a vertex; meaningless where edges are open or not
  // manifold.
  SolidTopology solid;
  bool manifold() const { return openEdges + nonManifoldEdges + nonManifoldVertices == 0; }
};

// Of triangles that are seen from outside counter-clockwise. Indices must be in range.
BoundaryTopology boundaryTopology(const Points& vertices, const std::vector<Triangle>& triangles);

// Of the solid's own surface where that is closed, manifold (vertices in one place counted as one)
// and nothing overlaps; else `clean` is false, and only a grid can tell.
struct SurfaceTopology {
  bool clean = false;
  SolidTopology solid;
};
SurfaceTopology surfaceTopology(const Solid& solid);

struct OuterSurfaceSettings {
  int resolution = 0;  // cells of the lattice along the longest side of the box, in [8, 1024]; 0:
                       // 80, and more where the solid is thin
  // Of all handles of the surface, at least 0. Without: those that the solid has at three
  // resolutions.
  std::optional<int> handles;
  bool onePiece = false;  // the largest part alone
};

// Where the surface has another topology than the solid, so that it has no handle there.
struct TopologyChange {
  Vec3 place;       // its middle, world units
  double size = 0;  // the diagonal of its box, world units
};

struct OuterSurface {
  Mesh mesh;               // world units; closed, manifold, outward, without self-intersections
  double edge = 0;         // of the lattice's cells, world units
  SolidTopology topology;  // of the mesh
  std::vector<TopologyChange> cuts;   // parts that meet are cut apart
  std::vector<TopologyChange> plugs;  // tunnels are closed
  std::vector<Box3> caps;             // of the mesh, where it was open; world units
  // Parts of less than a thousandth of the volume of the largest, or all others; and their share of
  // the volume.
  std::size_t leftOut = 0;
  double leftOutShare = 0;
  double insideOut = 0;  // as Solid::insideOut()
  // Of the solid's surface (Solid::surface()) from the mesh, fractions of the diagonal; cuts and
  // plugs are part of the mesh alone.
  double apartP99 = 0, apartMax = 0;
};

// The surface of what the mesh encloses (winding number above 1/2), holes closed, overlaps united,
// with the topology of the mesh instead of the union's: where parts of one body touch or run
// through one another the union has handles that the body has not, and so has a body with a dent
// that comes out on its other side. The solid is grown again on a lattice, node by node from its
// deepest part, by nodes that change no topology (Bertrand 1994); what cannot be taken is a cut. A
// tunnel that takes less to close than to cut open is closed first, where it is narrowest. Then as
// tetrahedralization(): isosurface stuffing, boundary vertices on the solid's surface. Sharp edges
// are cut across. Pockets that are enclosed are filled.
//
// Deterministic. Throws SettingError, MemoryError (before allocating), Cancelled; DataError where
// nothing is inside at the resolution, no part of the solid has the handles that are asked for, or
// there are more than 64 that nobody asked for.
OuterSurface outerSurface(const Solid& solid, const OuterSurfaceSettings& settings = {});

// What filling a solid with tetrahedra takes.

// Estimates, from above by up to about a quarter.
struct StuffingNeed {
  std::size_t tetrahedra = 0, vertices = 0;
  std::uint64_t memory = 0;  // bytes, the peak beyond the solid
};

// spacing: of the lattice, world units, positive.
StuffingNeed stuffingNeed(const Solid& solid, double spacing);

}  // namespace innermap
