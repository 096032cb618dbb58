// The main job in one call: from two boundaries to the harmonic map of the inside, with its
// certificate.
//
// fitMap places charges just outside the source and solves for their weights, so that the map meets
// the target at boundary points (the method of fundamental solutions: Li, Guo, Wang, He, Gu and
// Qin, "Meshless harmonic volumetric mapping using fundamental solution methods", IEEE T-ASE 6(3),
// 2009). By default it adds charges where the error is until 99% of the boundary lies within a
// tolerance; see field/fit.h. FitMapSettings::shell asks for a number of charges on one
// shell instead, as in the paper.
//
// In space one harmonic map may fold, and between unrelated solids most do. Such a map is made in
// steps through intermediate shapes, each harmonic; see ComposedMap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/field/fit.h"
#include "innermap/fit/mapped_solid.h"

namespace innermap {

// What fitMap takes and gives.

// A number of charges, whatever the error.
struct ShellSettings {
  std::size_t sources = 2000;         // dense: at most 20000
  std::size_t collocation = 0;        // boundary points, at least sources + 4; 0: chosen
  std::optional<double> distance;     // of the source's diagonal
  std::optional<double> radiusRatio;  // not together with a distance
  FitSolver solver = FitSolver::automatic;
  Regularization method = Regularization::tikhonov;
  std::optional<double> regularization;
};

// Without the numbers of charges and points.
std::vector<Setting> describe(ShellSettings& settings);
SettingChoice regularizationChoice(Regularization* method);

// Boundary points of these settings: `collocation`, or its default.
std::size_t shellCollocation(const ShellSettings& shell);

// What to do about folds. automatic: go in steps if one harmonic map folds more than kManyFolds of
// the inside or takes more than kManyOutside of it out of the target. If its first charges fold
// twice that share, the map is not fitted to the end. Steps then fold at most kFewFolds of the
// checked points inside: single points beside the surface fold where charges are near, and smaller
// steps seldom help. on: smaller steps until no checked point folds and no cell is proven to. off:
// one harmonic map, whose folds are counted. More charges do not cure folds: a horse's pose folds
// on 0.035% of its volume with 6,400 charges and with 26,600.
enum class OneToOne { automatic, on, off };
constexpr double kManyFolds = 5e-3, kManyOutside = 1e-2, kFewFolds = 4e-4;

// FitMapSettings::tolerance of solids that were laid onto each other, unless told otherwise: their
// surfaces follow each other within some thousandths anyway. A fraction of the target's diagonal.
constexpr double kLaidOnTolerance = 2e-3;

// What maps in steps take beside a single one in bytes: the most that was measured between
// unrelated solids of some 10,000 triangles, where 0.3e9 is as common.
constexpr std::uint64_t kStepsMemory = 700'000'000;

struct FitMapSettings {
  // 99% of the boundary should lie within it; fraction of the target's diagonal, in
  // [kSmallestTolerance, 1]. Not used with `shell`.
  double tolerance = 1e-3;
  std::size_t maxSources = 100000;  // that the tolerance may take
  std::optional<ShellSettings> shell;
  Interpolation interpolation = Interpolation::automatic;
  OneToOne oneToOne = OneToOne::automatic;  // with `shell` folds are counted, no more
  int maxSteps = 64;
  Prove prove = Prove::core;
  // ProofSettings::cellsPerCharge. Of maps in three to five steps this leaves 1 to 3% of the solid
  // undecided, where a hundred leave 0.01%. Of maps in more than eight steps there are fewer, by
  // the square of the steps over eight, but one at least. With oneToOne on, and with Prove::full,
  // as many as ProofSettings has at least.
  double proofCells = kProofCells;
  std::uint64_t seed = 1;
};

// What settings of several structs share: the tolerance that 99% of the boundary is to meet, and
// the charges that may be taken for it.
Setting toleranceSetting(SettingValue tolerance);
Setting maxSourcesSetting(std::size_t* most);

// Without the tolerance and the shell.
std::vector<Setting> describe(FitMapSettings& settings);

// Throws SettingError for what is out of range, or excludes something else.
void requireInRange(const FitMapSettings& settings);

// tikhonov, truncatedSvd: of a dense solve, by what regularises it. steps: each of a map's by
// itself.
enum class SolveMethod { adaptive, iterative, tikhonov, truncatedSvd, steps };
enum class MapPlacement { adaptive, shell, sphere, steps };

// As reports and files have them: "adaptive", "tsvd", ...
std::string wordOf(SolveMethod method);
std::string wordOf(MapPlacement placement);

// How the charges were placed and their weights found. Lengths are fractions of the source's
// diagonal.
struct MapSolve {
  SolveMethod method = SolveMethod::adaptive;
  MapPlacement placement = MapPlacement::adaptive;
  std::size_t sources = 0, collocation = 0, heldOut = 0, rank = 0;
  double distance = 0;                       // of the charges, of the first level; none on a sphere
  double radiusRatio = 0;                    // of a sphere
  double regularization = 0, condition = 0;  // of a dense solve
  double weightNorm = 0;
  double productError = 0;  // as in IterativeSolution
  int iterations = 0;
  std::vector<double> residuals;      // rms at the collocation points, of iterative solves
  std::vector<DistanceTrial> trials;  // that chose the distance
  std::vector<AdaptiveLevel> levels;  // of an adaptive placement
  std::vector<AdaptiveRound> rounds;
};

struct ToleranceOutcome {
  double wanted = 0, reached = 0;  // fractions of the target's diagonal
  bool met = false;
  // Why no more was reached, when it is not met; `met` then means that Interpolation::smooth fits
  // the vertices only.
  AdaptiveEnd end = AdaptiveEnd::met;
};

// What the map does to points inside the source.
struct InsideFigures {
  std::size_t samples = 0;          // of a lattice through the inside
  double folded = 0;                // share of them where the Jacobian determinant is not above 0
  double outside = 0;               // share whose image is farther out of the target than error.p99
  Points foldedAt;                  // the first of them, at most 16, world units of the source
  DeterminantFigures determinants;  // of them
};

struct MapFit : MappedSolid {
  // The certificate, against the boundary's triangles: at 20,000 random boundary points that took
  // no part in the fit; its largest value, looked for (see certify), is the largest error anywhere
  // inside (maximum principle; of one harmonic map). All here are fractions of the target's
  // diagonal.
  BoundaryError error;
  double collocationError = 0;        // sum of squares at the collocation points (C-Error)
  bool smooth = false;                // fitted to the vertices of a smooth deformation
  std::optional<double> verticesRms;  // then: at vertices that it never saw
  std::optional<double> verticesMax;  // and the largest at any
  // Else: about how far the triangles are at most from a smooth deformation that the vertices may
  // be samples of, as vertices about each triangle tell that had no part in it.
  std::optional<double> triangles;
  // With kCertificateConfidence the map is nowhere farther from such a smooth deformation, if it is
  // harmonic inside.
  double smoothBound = 0;
  std::optional<ToleranceOutcome> tolerance;  // none with `shell`
  MapSolve solve;
  InsideFigures inside;
  std::vector<MapStep> steps;  // none of a single harmonic map
  // Of the fit, a line each; those of its boundaries stand in `boundary`, and here too when fitMap
  // was given meshes.
  std::vector<std::string> notes, warnings;
  StageSeconds seconds;  // "sample", "fit", "certificate", "inside", "steps", "proof"
};

// Bytes that a fit to so many vertices of the source needs beside their boundaries, with measuring
// its result; with a tolerance, for its first level of charges. Nobody knows beforehand how many
// follow and whether the map goes in steps: fitMap adds charges while the process stays within the
// limit on memory, and keeps the single map if steps do not fit.
std::uint64_t fitMapMemory(const FitMapSettings& settings, std::size_t vertices);

// A tolerance that cannot be met is no error: see MapFit::tolerance. Throws SettingError, DataError
// (no inside, another connectivity, no room for charges), MemoryError, Cancelled. Deterministic for
// a seed, whatever the number of threads.
MapFit fitMap(BoundaryPair boundary, const FitMapSettings& settings = {});

// The same from two meshes of one connectivity (see readMeshLike); others are laid onto one another
// first, see mesh_correspondence.h.
MapFit fitMap(const Mesh& source, const Mesh& target, const FitMapSettings& settings = {});

// How a map is to be fitted, as a person says it: with what a program or a script was given.

// Placing a number of charges on one shell goes without a tolerance.
struct FitChoices {
  std::optional<double> tolerance;  // without: that of `fit`, or kLaidOnTolerance
  std::optional<std::size_t> sources, collocation;
  ShellSettings shell;  // but for its sources and collocation
  FitMapSettings fit;   // but for its tolerance and shell

  // The first of them that places a number of charges, as it is called; empty where none does.
  std::string placedBy() const;

  // laidOn: the source was laid onto the target. Throws SettingError where choices exclude one
  // another.
  FitMapSettings settings(bool laidOn) const;
};

std::vector<Setting> describe(FitChoices& choices);

}  // namespace innermap
