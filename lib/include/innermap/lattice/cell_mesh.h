// Meshes of tetrahedra and hexahedra, with the fields that simulators keep on them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

// (b - a, c - a, d - a) is right-handed where the cell is not inverted, as in VTK, Gmsh and MEDIT.
using Tetrahedron = std::array<int, 4>;

// Corners as VTK, Gmsh and MEDIT number them: the lower quadrilateral counter-clockwise seen from
// above, then the upper one above it.
using Hexahedron = std::array<int, 8>;

// Values on points or cells: rows of `components` values, one row each.
struct CellField {
  enum class Kind {
    scalar,  // and all that moving the mesh leaves as it is
    vector,  // three components, a direction with a length: turned by the map's Jacobian
    normal   // three components, of a surface: turned by the Jacobian's inverse transpose
  };
  std::string name;
  int components = 1;
  Kind kind = Kind::scalar;
  std::vector<double> values;
  bool whole = false;  // whole numbers (labels, say), and written to files as such
};

struct CellMesh {
  std::string name;                     // the file's path, or what error messages should call it
  Points vertices;                      // #V, world units
  std::vector<Tetrahedron> tetrahedra;  // #T
  std::vector<Hexahedron> hexahedra;    // #H
  std::vector<CellField> vertexFields;  // #V rows each
  std::vector<CellField> cellFields;    // #T + #H rows each: tetrahedra, then hexahedra
};

// Where a map takes the vertices of a mesh.
struct CarriedCells {
  Points positions;  // #V
  // #V: of vertices of the boundary, their places on the surface; triangle -1 for the others.
  std::vector<SurfacePoint> onSurface;
};

// Throws DataError when an index is out of [0, #V), a cell uses a vertex twice, a vertex that a
// cell uses is not finite, or a field has the wrong size; the message names mesh.name.
void validate(const CellMesh& mesh);

// det(b - a, c - a, d - a) / 6: negative where the cell is inverted. World units cubed.
double signedVolume(const Points& vertices, const Tetrahedron& cell);

// Each corner with its three neighbours, right-handed. One that is inverted is a corner at which
// the trilinear cell is; all eight positive do not prove the cell itself so.
std::array<Tetrahedron, 8> cornerTetrahedra(const Hexahedron& cell);

// Faces that belong to one cell only, seen from outside counter-clockwise; quadrilaterals of
// hexahedra cut in two. Indices into mesh.vertices. In the order of the cells.
std::vector<Triangle> boundaryTriangles(const CellMesh& mesh);

}  // namespace innermap
