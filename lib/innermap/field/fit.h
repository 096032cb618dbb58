// From boundary values to a field: where the charges stand is chosen by the error at held-out
// points, then their weights are solved for.
//
// Smooth boundary values want the charges far from the boundary, where few of them resolve much;
// values with kinks want them at about one spacing. So unless a distance is given, some are tried
// with few charges first: from 0.8 spacings, about
// doubling, up to half the diagonal; a farther one must lower the error by a fifth.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/solve/dense_solver.h"
#include "innermap/solve/iterative_solver.h"

namespace innermap {

constexpr std::size_t kMaxCharges = 1'000'000;  // of any fit

// Points in random order: any first part of them covers the boundary evenly. values: #points x #K.
struct BoundaryData {
  Points points, heldOut;
  Matrix values, heldOutValues;
  Points directions{}, heldOutDirections{};  // as Collocation::directions
};

struct FitProblem {
  BoundaryData surface;   // anywhere on the boundary, values linear between the mesh's vertices
  BoundaryData vertices;  // the mesh's vertices alone; may be empty
  double diagonal = 0;    // of the solid, world units: the unit of distances
  double area = 0;        // of the boundary, world units squared
  // Gives `count` source points at `distance` (fraction of the diagonal) from the boundary; throws
  // DataError where there is no room for any.
  std::function<Points(std::size_t count, double distance)> placeSources;
};

// What the boundary values are between a mesh's vertices. Linear: what the triangles say, kinks at
// the edges included. Smooth: the vertices sample a smooth deformation, and the fit passes through
// them alone; far more exact inside when that is so. Automatic: smooth when it predicts held-out
// vertices at least four times as well.
enum class Interpolation { automatic, linear, smooth };

// Dense: one factorization of the whole matrix, time as the cube and memory as the square of the
// number of sources. Iterative: both in proportion, for linear interpolation, sources at about one
// spacing. Automatic: dense up to kMostDenseSources.
enum class FitSolver { automatic, dense, iterative };
constexpr std::size_t kMostDenseSources = 3000;

struct FitSettings {
  std::size_t sources = 2000;  // in [1, kMaxCharges]; dense: at most 20000
  FitSolver solver = FitSolver::automatic;
  std::optional<double> distance;  // fraction of the diagonal, in [1e-4, 2]; chosen when absent
  std::size_t trialSources = 600;  // of trials of distances, at most; half the sources at most
  Interpolation interpolation = Interpolation::automatic;
  Regularization method = Regularization::tikhonov;
  std::optional<double> regularization;  // relative, in [0, 1]; chosen when absent
};

struct DistanceTrial {
  std::size_t sources = 0;
  double distance = 0;    // fraction of the diagonal
  bool smooth = false;    // fitted to the vertices
  double heldOutRms = 0;  // in the values' units
};

struct FitResult {
  HarmonicField field;
  bool iterative = false;
  double distance = 0;
  bool smooth = false;  // fitted to the vertices; then with at most half as many sources as those
  std::vector<DistanceTrial> trials;  // empty when the distance was given
  double weightNorm = 0;              // as in DenseSolution
  // Dense solver: as in DenseSolution.
  double regularization = 0, condition = 0;
  std::size_t rank = 0;
  // Iterative solver: rms at the collocation points before and after each iteration.
  std::vector<double> residuals;
  double productError = 0;  // as in IterativeSolution
};

// Peak need in bytes of a fit with so many points.
std::uint64_t fitMemory(std::size_t collocation, std::size_t sources, std::size_t heldOut,
                        FitSolver solver);

// Throws SettingError, DataError (no room for sources at any distance), MemoryError, Cancelled.
FitResult fitField(const FitProblem& problem, const FitSettings& settings = {});

// fitField for vertices that sample a smooth deformation (settings.interpolation: smooth, or
// automatic and they do); nothing when they do not. Throws as fitField does.
std::optional<FitResult> fitSmooth(const FitProblem& problem, const FitSettings& settings = {});

}  // namespace innermap
