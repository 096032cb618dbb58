// The work of fitMap: a fit of one harmonic map or of one in steps, certified and checked.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fit/detail/inside_check.h"
#include "fit/detail/map_certificate.h"
#include "fit/detail/problem_samples.h"
#include "fit/detail/value_jumps.h"
#include "fit/target_shape.h"
#include "innermap/fit/fit_map.h"
#include "innermap/fit/surface_problem.h"

namespace innermap {

// Of a first fit where a tolerance is asked for: enough to tell smooth deformations from others.
constexpr PointCounts kFirstCounts{1000, 4000, 1000};

// Points of a fit with a number of charges.
PointCounts pointCounts(const ShellSettings& shell);

// What is known of a fit before it becomes a MapFit.
struct FitOutcome {
  ComposedMap map;
  BoundaryError error;
  MapCertificate certificate;
  double collocationError = 0;
  bool smooth = false;
  std::optional<double> verticesRms;
  std::optional<ToleranceOutcome> tolerance;
  MapSolve solve;
  InsideFigures inside;
  std::vector<MapStep> steps;
  std::optional<ProofFigures> proof;  // once it was tried
};

class MapFitter {
 public:
  // Keeps references to both.
  MapFitter(const BoundaryPair& pair, const FitMapSettings& settings);

  StageSeconds seconds;
  // Of one harmonic map, when there are steps instead.
  double singleFolded = 0;
  std::size_t singleSources = 0;
  std::vector<std::string> warnings;
  std::vector<ValueJump> jumps;  // larger than the tolerance of an adaptive fit

  FitOutcome onShell(const ShellSettings& shell);

  // mayStop: with the first charges, if these leave no doubt that steps are needed.
  FitOutcome within(double tolerance, bool mayStop = true);

  // Counts folds, and goes in steps where there are too many.
  void check(FitOutcome& out);

  // After check().
  Injectivity injectivityOf(FitOutcome& out);

 private:
  void prove(FitOutcome& out);
  bool foldsTooMuch(const FitOutcome& out) const;
  bool areBetter(FitOutcome& steps, const FitOutcome& single);
  bool mayTakeSteps() const;
  const Points& inside();
  MappedPoints insideOf(const ComposedMap& map);
  bool roomForSteps();
  void finishSingle(FitOutcome& out);
  AdaptiveProblem problem(double tolerance);
  FitProblem problemOf(const PointCounts& counts);
  AdaptiveSettings adaptiveSettings(double tolerance) const;
  InsideFigures figuresOf(const FitOutcome& out);
  FitOutcome inSteps();
  std::optional<FitOutcome> tryVertices(double tolerance);
  void measure(const FitProblem& problem, FitOutcome& out);
  void certify(FitOutcome& out);

  const BoundaryPair& pair_;
  const FitMapSettings& settings_;
  const int orientation_;  // of the target
  Points inside_;
  std::optional<TargetShape> target_;
};

}  // namespace innermap
