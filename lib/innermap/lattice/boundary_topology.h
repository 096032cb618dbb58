// How many parts, hollows and handles a closed surface has, and whether it is one.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "innermap/lattice/cell_mesh.h"
#include "innermap/levelset/solid.h"

namespace innermap {

struct SolidTopology {
  int components = 0;  // shells that face outwards
  int cavities = 0;    // shells that face inwards
  int handles = 0;     // of all shells: a torus has one
};
bool operator==(const SolidTopology& a, const SolidTopology& b);
std::string describe(const SolidTopology& topology);  // "1 component, 0 cavities, 2 handles"

struct BoundaryTopology {
  std::size_t openEdges = 0;              // with one triangle
  std::size_t nonManifoldEdges = 0;       // with more than two, or two that run the same way
  std::size_t nonManifoldVertices = 0;    // whose triangles form more than one fan
  std::vector<int> eulerCharacteristics;  // of each shell, cut apart where parts touch in a vertex
  SolidTopology solid;                    // meaningless where edges are open or not manifold
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

}  // namespace innermap
