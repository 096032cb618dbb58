// Finite elements and charges side by side: the same boundary values, harmonic functions inside by
// either, their errors at the same points, and the time that each takes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/setting.h"
#include "innermap/fit/fit_map.h"
#include "innermap/lattice/cell_mesh.h"
#include "innermap/levelset/solid.h"

namespace innermap {

struct CompareFemSettings {
  std::vector<int> resolutions{16, 32, 64};  // of the tetrahedra, each in [4, 1024]; ascending
  // Of the charges, in the order given: how many for known functions, in [16, 20000]; the tolerance
  // for maps, as in FitMapSettings.
  std::vector<std::size_t> charges{250, 500, 1000};
  std::vector<double> tolerances{4e-3, 1e-3, 4e-4};
  double referenceTolerance = 2e-4;  // of the fit that real maps are compared with
  std::size_t samples = 20000;       // points inside, in [100, 1e6]
  std::uint64_t seed = 1;
};

// Without the lists.
std::vector<Setting> describe(CompareFemSettings& settings);

// Positions, and the same of all three channels: gradients[3 k + axis].
struct InsideValues {
  Vec3 value;
  std::array<double, 9> gradient{};
};
using InsideFunction = std::function<std::vector<InsideValues>(const Points&)>;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// One method at one size. Errors of known functions are relative, in the L2 norm, of the worst of
// the three; those of maps fractions of the target's diagonal (values) and relative (gradients).
struct ComparedRow {
  bool charges = false;      // else finite elements
  std::size_t size = 0;      // charges or tetrahedra
  double edge = 0;           // of the tetrahedra's lattice, world units
  std::size_t unknowns = 0;  // of one channel
  int iterations = 0;        // of conjugate gradients; 0 of charges
  double seconds = 0;        // wall time from the solid to the function
  std::uint64_t memory = 0;  // bytes, by the estimates that --max-memory is held against
  double value = kUnknown, gradient = kUnknown;
  double largest = kUnknown;  // of the values' errors, in their unit
  double jump = 0;            // of gradients from cell to cell, rms, relative; 0 of charges
  // Of maps alone.
  double harmonicEnergy = kUnknown, deformationEnergy = kUnknown;  // at the points, unit volumes
  double folded = kUnknown;       // share of the points where the Jacobian is not above 0
  std::size_t inverted = 0;       // tetrahedra that the map inverts
  double boundaryRms = kUnknown;  // of charges: their certificate, fraction of the diagonal
  InsideFunction function;
};

struct CompareFem {
  std::vector<ComparedRow> rows;  // finite elements, coarse to fine, then charges
  // Between the two finest tetrahedra with an error: log of the ratio of errors over that of edges.
  double valueOrder = kUnknown, gradientOrder = kUnknown;
  double referenceRms = 0, referenceSeconds = 0;  // of maps: of the fit compared with
  std::vector<std::string> notes;
};

// The functions x^2 - y^2, exp(4 x) sin(4 y) and a charge 0.1 outside, in coordinates that put the
// solid's box in the unit cube (lower corner at 0).
CompareFem compareFemOnFunctions(const Solid& solid, const CompareFemSettings& settings = {});

// The harmonic map of a pair of boundaries: one map, not in steps. The reference is a fit of
// charges too, to `referenceTolerance`, which favours them; errors below twice its own boundary
// error say little, as a note says. Rows that are the reference itself have no errors.
CompareFem compareFemOnMap(const BoundaryPair& pair, const CompareFemSettings& settings = {});

// Peak need in bytes, an estimate.
std::uint64_t compareFemMemory(const Solid& solid, const CompareFemSettings& settings);

// Harmonic functions by linear finite elements: what a variational method makes of the boundary
// values that charges are fitted to.

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
