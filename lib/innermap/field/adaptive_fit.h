// From a wanted accuracy to a field: charges are placed where the error is, on levels whose spacing
// and distance halve, until 99% of the boundary lies within the tolerance.
//
// The first level covers the whole boundary. Then, again and again: the error is measured at fresh
// points, those where it is too large are marked, and around each mark charges are added on the
// next finer level than it has had so far; boundary points are added around the new charges; all
// weights are solved for, starting from those that are there. As each round's points are new ones,
// none of them has played a part in fitting or marking, and the error is measured without bias.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"
#include "innermap/field/boundary_error.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/solve/collocation.h"

namespace innermap {

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
