// A mesh of cells as tetrahedra with shapes at rest: what moving its vertices is judged by.
#pragma once

#include <cstddef>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/lattice/cell_mesh.h"

namespace innermap {

enum class RestShape {
  own,     // as the cells are; regular for those that are inverted
  regular  // all edges of a tetrahedron alike, of a hexahedron's corner alike and square
};

struct CellSystem {
  CellSystem(const CellMesh& mesh, RestShape shape);

  Mat3 rest(int tet) const;  // inverse matrix of the edges at rest; world units
  // det J / (|J|^2 / 3)^(3/2) for J from the shape at rest: 1 where that is kept, at most 0 where
  // the tetrahedron is inverted.
  double quality(const Points& at, int tet) const;

  std::size_t vertices() const { return first.size() - 1; }

  const Points& places;           // of the mesh, which must stay
  std::vector<Tetrahedron> tets;  // of the mesh, then the corners' of its hexahedra, 8 each
  std::size_t ownTets = 0;        // of the mesh
  RestShape shape;
  std::vector<std::size_t> first;  // #V + 1
  std::vector<int> around;         // tets of vertex v: first[v] to first[v + 1], ascending
  std::vector<Triangle> boundary;  // as boundaryTriangles
  std::vector<char> onBoundary;    // #V
};

// Tetrahedra whose quality is below `least`, ascending.
std::vector<int> poorTets(const CellSystem& system, const Points& at, double least);

// Cells of which a tetrahedron has no positive volume.
std::size_t invertedCells(const CellMesh& mesh, const Points& at);

// A part of the mesh in which some vertices may move.
struct CellPatch {
  std::vector<int> vertices;  // those that move first, ascending; then those that hold them
  std::size_t moving = 0;
  std::vector<int> tets;  // that have a vertex that moves, ascending
};

// All vertices that are at most `rings` edges from the tetrahedra given may move, but for those of
// the boundary unless it slides; in parts that have no tetrahedron in common, in order of their
// first vertices.
std::vector<CellPatch> growPatches(const CellSystem& system, const std::vector<int>& seeds,
                                   int rings, bool boundaryMoves);

// All of it as one.
CellPatch wholePatch(const CellSystem& system, bool boundaryMoves);

}  // namespace innermap
