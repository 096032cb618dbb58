// Harmonic functions by linear finite elements: what a variational method makes of the boundary
// values that charges are fitted to.
#pragma once

#include <cstddef>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/lattice/cell_mesh.h"

namespace innermap {

struct HarmonicCellsSettings {
  double residual = 1e-9;    // relative, at which conjugate gradients end, in (0, 1)
  int maxIterations = 5000;  // at least 1
};

struct HarmonicCells {
  Matrix values;  // #V x #K; 0 at vertices of no tetrahedron
  std::size_t unknowns = 0;
  int iterations = 0;   // the most of all channels
  double residual = 0;  // relative, the largest
};

// Of the functions that are linear in each tetrahedron and have the given values at the boundary's
// vertices, those of least Dirichlet energy: the stiffness matrix, conjugate gradients
// preconditioned by an incomplete Cholesky factor (Lin and Moré, "Incomplete Cholesky
// factorizations with limited memory", SIAM J. Sci. Comput. 1999; Eigen's), a thread a channel.
// boundaryValues: #V x #K; rows of other vertices do not count. Throws DataError for sizes that
// disagree, hexahedra, a cell without positive volume, or when the residual is not reached;
// SettingError, Cancelled.
HarmonicCells harmonicOnCells(const CellMesh& mesh, const Matrix& boundaryValues,
                              const HarmonicCellsSettings& settings = {});

// Gradients of the four linear functions that are 1 at one corner and 0 at the others; not finite
// where the cell has no volume.
std::array<Vec3, 4> cornerGradients(const Points& vertices, const Tetrahedron& cell);

// Where vertices are on the boundary. #V.
std::vector<bool> boundaryVertices(const CellMesh& mesh);

// Peak need in bytes beside the mesh of harmonicOnCells with three channels, an upper bound.
std::uint64_t harmonicCellsMemory(std::size_t vertices, std::size_t tetrahedra);

}  // namespace innermap
