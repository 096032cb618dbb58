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

#include "innermap/boundary/fit_map.h"
#include "innermap/core/setting.h"
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

}  // namespace innermap
