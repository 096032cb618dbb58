// From boundary values to a field: where the charges stand is chosen by the error at held-out
// points, then their weights are solved for.
//
// Smooth boundary values want the charges far from the boundary, where few of them resolve much;
// values with kinks want them at about one spacing. So unless a distance is given, some are tried
// with few charges first: from 0.8 spacings, about
// doubling, up to half the diagonal; a farther one must lower the error by a fifth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/solve/solver.h"

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

// How far a field is from its boundary values at points that took no part in the fit. As the field
// is harmonic, the largest error on the boundary bounds the error everywhere inside.

struct BoundaryError {
  // Euclidean length of the error over all channels, divided by `unit`.
  double rms = 0, p99 = 0, max = 0;
  double sumOfSquares = 0;  // the paper's C-Error when taken at the collocation points
  std::size_t samples = 0;
  // With kCertificateConfidence: at least 99% of the boundary is within p99Bound, all of it within
  // bound; for uniform samples. See certify, whose `max` and `bound` are those of a search.
  double p99Bound = 0, bound = 0;
  std::size_t searched = 0;  // points beside `samples` at which the largest was looked for
  Vec3 maxAt;                // where it was met, world units of the source
  double missed = 0;         // share of the samples over the tolerance that certify was given
};

constexpr double kCertificateConfidence = 0.95;

// Fraction of the target's diagonal: a map whose error reaches it is not to be trusted.
constexpr double kDoubtfulError = 0.1;

struct BoundaryErrorSettings {
  double accuracy = 0;  // of the field's values, as HarmonicField::evaluate takes it; 0: plain sums
};

// The Euclidean length of the error over all channels at each point, divided by `unit`. Arguments
// and errors as below.
std::vector<double> boundaryErrors(const HarmonicField& field, const Collocation& at,
                                   const Matrix& values, double unit,
                                   const BoundaryErrorSettings& settings = {});

// Of the lengths at all points, which are taken for uniform ones. p99Bound and bound are infinite
// where these are too few for them.
BoundaryError summarizeErrors(std::vector<double> lengths);

// values: #points x #K. unit: usually the target's diagonal; must be positive.
// Throws DataError when sizes disagree, SettingError for a bad unit.
BoundaryError measureBoundaryError(const HarmonicField& field, const Collocation& at,
                                   const Matrix& values, double unit,
                                   const BoundaryErrorSettings& settings = {});

// From a wanted accuracy to a field: charges are placed where the error is, on levels whose spacing
// and distance halve, until 99% of the boundary lies within the tolerance.
//
// The first level covers the whole boundary. Then, again and again: the error is measured at fresh
// points, those where it is too large are marked, and around each mark charges are added on the
// next finer level than it has had so far, or on finer ones where a gap is too narrow for that;
// boundary points are added around the new charges; all weights are solved for, starting from those
// that are there. As each round's points are new ones, none of them has played a part in fitting or
// marking, and the error is measured without bias.

// The smallest tolerance that can be asked for: sums of 1e4 to 1e5 charges whose weights cancel a
// hundredfold keep some 12 of double precision's 16 digits.
constexpr double kSmallestTolerance = 1e-12;

struct BoundarySamples {
  Points points;  // on the boundary, world units
  Matrix values;  // #points x #K
  // As Collocation::directions: where one is not zero, the derivative is what `values` holds.
  Points directions{};

  Collocation collocation() const { return {points, directions}; }
};

// Where points may stand: nearer than `reach` to a mark, or anywhere when there are no marks; no
// nearer than `spacing` to one another and to those that are there. Lengths are fractions of the
// diagonal.
struct PlacementRequest {
  Points marks;
  double reach = 0, spacing = 0;
  Points existing;
  std::size_t most = 0;     // points
  std::uint64_t index = 0;  // another one for each request: for seeds
};

// The boundary, as functions that the caller has.
struct AdaptiveProblem {
  double diagonal = 0;  // of the solid, world units
  double area = 0;      // of the boundary, world units squared
  double unit = 0;      // of errors: the values' diagonal
  // Places where the values jump, as no harmonic field does, by more than the tolerance. Charges
  // get a few levels finer about them, and the error that is left there does not ask for more.
  Points jumps;
  // `count` random points, uniform by area; independent ones for each `draw`.
  std::function<BoundarySamples(std::size_t count, std::uint64_t draw)> draw;
  // Source points at `distance` (fraction of the diagonal) from the boundary, over marked parts of
  // it; none where another part of it is nearer.
  std::function<Points(const PlacementRequest& request, double distance)> placeSources;
  // Points of the boundary.
  std::function<BoundarySamples(const PlacementRequest& request)> placeCollocation;
};

struct AdaptiveSettings {
  double tolerance = 1e-3;          // fraction of the unit, in [kSmallestTolerance, 1]
  std::size_t firstSources = 1000;  // about; of the first level, in [10, 5000]
  std::size_t maxSources = 100000;  // in [firstSources, kMaxCharges]
  std::size_t checkSamples = 20000;
  int patience = 6;       // rounds that may gain less than 3% in all, at least 1
  int outlierRounds = 6;  // at most, once the tolerance holds, for errors that stand out
  // Asked with the field of each round, if given; that of the first has the first level alone.
  // Where the answer is no the fit ends there (AdaptiveEnd::stopped).
  std::function<bool(const HarmonicField& field, int round)> goOn;
};

// Why an adaptive fit ended; jumps: the tolerance holds but about them; time: at the deadline of
// the run.
enum class AdaptiveEnd { met, maxSources, maxMemory, noGain, jumps, stopped, time };

struct AdaptiveRound {
  std::size_t sources = 0, collocation = 0;
  int iterations = 0;
  BoundaryError error;  // at this round's fresh points, but what is left at jumps
};

struct AdaptiveLevel {
  double distance = 0, spacing = 0;  // fractions of the diagonal
  std::size_t sources = 0;
};

struct AdaptiveResult {
  HarmonicField field;
  // At draw 0, checkSamples points that only decide whether the tolerance holds.
  BoundaryError error;
  AdaptiveEnd end = AdaptiveEnd::met;
  std::vector<AdaptiveRound>
      rounds;  // the last of them is not always the one returned: the best is
  std::vector<AdaptiveLevel> levels;  // of the field returned
  std::size_t collocation = 0;
  std::vector<double> residuals;  // of the solve that gave the field, as in IterativeSolution
  double weightNorm = 0;
  double productError = 0;  // as in IterativeSolution
};

// A tolerance that is not met is no error: `end` says why. Throws SettingError, MemoryError (not
// even the first level fits), DataError (no room for it), Cancelled.
AdaptiveResult fitToTolerance(const AdaptiveProblem& problem,
                              const AdaptiveSettings& settings = {});

}  // namespace innermap
