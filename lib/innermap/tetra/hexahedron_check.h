// Whether a trilinear hexahedron is right side out everywhere, not at its corners alone.
//
// Its Jacobian determinant is a polynomial of degree 2 in each of the three coordinates. Of its 27
// Bernstein coefficients over the unit cube those at the corners are values, and all together bound
// it: all positive proves that it is so everywhere. Where that is undecided the cube is halved
// along each axis and each part looked at. After Johnen, Weill and Remacle, "Robust and efficient
// validation of the linear hexahedral element" (IMR 2017).
#pragma once

#include <cstddef>

#include "innermap/lattice/cell_mesh.h"

namespace innermap {

struct JacobianBounds {
  double lower = 0, upper = 0;  // the least determinant over the cell lies between them
  bool proven() const { return lower > 0; }     // right side out everywhere
  bool inverted() const { return upper <= 0; }  // somewhere not
};

// Of the map from the unit cube: 1 for a unit cube, in world units cubed. Ends as soon as the sign
// is decided, or after `halvings` in [0, 10].
JacobianBounds leastJacobian(const Points& vertices, const Hexahedron& cell, int halvings = 5);

struct HexahedronCheck {
  std::size_t inverted = 0;         // determinant not positive somewhere
  std::size_t invertedCorners = 0;  // of these, at a corner
  std::size_t undecided = 0;        // neither proven positive nor found to be inverted
  bool proven() const { return inverted == 0 && undecided == 0; }
};

struct HexahedronCheckSettings {
  int halvings = 5;  // in [0, 10]
};

// Of all hexahedra of the mesh. Throws SettingError, Cancelled.
HexahedronCheck checkHexahedra(const CellMesh& mesh, const HexahedronCheckSettings& settings = {});

}  // namespace innermap
