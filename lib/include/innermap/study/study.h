// How the error, the energies and the stability of a map depend on its settings: the same pair of
// boundaries fitted again and again, with other numbers of charges, boundary points a charge, and
// places of the charges.
//
// It is the study of Li, Guo, Wang, He, Gu and Qin, "Meshless harmonic volumetric mapping using
// fundamental solution methods" (IEEE T-ASE 6(3), 2009): their S-Ratio and C-Ratio (charges and
// collocation points per vertex), O-Distance (charges on an offset of the surface) and R-Ratio (on
// a sphere) against the C-Error. Beside that it has what they do not: the error between the
// collocation points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/evaluate/evaluate_map.h"
#include "innermap/fit/fit_map.h"

namespace innermap {

// What a study is made of: its settings, its runs, one fit each, and what became of them.

enum class ChargePlacement { offset, sphere };

// One fit.
struct StudyRun {
  std::size_t sources = 1000;  // charges, in [16, 20000]
  double collocation = 4;      // boundary points a charge, in [1, 100]; at least 4 more in all
  ChargePlacement placement = ChargePlacement::offset;
  // offset: the charges' distance, fraction of the source's diagonal, in [1e-4, 2]; sphere: its
  // radius over half that diagonal, in (1, 100].
  double at = 0.02;
};

// Boundary points of a run.
std::size_t collocationOf(const StudyRun& run);
bool sameRun(const StudyRun& a, const StudyRun& b);

// Beside each list alone: nothing; the product of each two lists, the others at their base; the
// product of all.
enum class StudyGrid { none, pairs, full };

struct StudySettings {
  // What is varied, each as in StudyRun, ascending; an empty list is not varied.
  std::vector<std::size_t> sources{125, 250, 500, 1000, 2000};
  std::vector<double> collocation{1, 1.5, 2, 3, 4, 6};
  std::vector<double> distances{0.0025, 0.005, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32};
  std::vector<double> radiusRatios{1.1, 1.5, 2, 3, 5};
  // What stays while another is varied.
  std::size_t baseSources = 1000;
  double baseCollocation = 4;
  std::optional<double> baseDistance;  // absent: the spacing of baseSources charges, to two digits
  double baseRadiusRatio = 1.5;
  StudyGrid grid = StudyGrid::pairs;

  Interpolation interpolation = Interpolation::linear;  // linear or smooth
  Regularization method = Regularization::tikhonov;
  std::optional<double> regularization;  // relative, in [0, 1]; chosen for each run when absent
  int resolution = 64;  // of the voxels that energies and folds are taken from, in [4, 1024]
  LameConstants lame;
  std::uint64_t seed = 1;  // of all random points, in [0, 1e15]
  // Where finished runs are kept, a file each, to be taken from there by the next study of the same
  // boundaries, settings and version; made when missing. Empty: nowhere.
  std::string folder;
  // Of the runs, only every shares-th is made, from the share-th on (1 to shares); the others are
  // taken from the folder, or left.
  std::size_t share = 1, shares = 1;
};

// Without the lists, the folder and the share.
std::vector<Setting> describe(StudySettings& settings);

// What became of a run. Errors are fractions of the target's diagonal; what is not known is NaN.
struct StudyRow : StudyRun {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::string failure;            // why there is no map; then there are no figures
  bool kept = false;              // taken from the folder
  std::size_t points = 0;         // boundary points
  double cError = kNone;          // sum of squares at the collocation points
  double collocationRms = kNone;  // rms there
  // At fresh points of the boundary, and the largest that was found, as in MapFit::error.
  double rms = kNone, p99 = kNone, max = kNone;
  double harmonicEnergy = kNone;     // both solids scaled to unit volume: 3 for a rigid motion
  double deformationEnergy = kNone;  // mean density: 0 for one
  double jacobianMin = kNone;        // at voxels
  double folded = kNone;             // share of the volume
  double weights = kNone;    // their size, dimensionless: about 1 for harmless fits (DenseSolution)
  double condition = kNone;  // of what the regularisation leaves
  double regularization = kNone;
  std::size_t rank = 0;
  double seconds = kNone;         // wall time of placing points and solving
  double secondsOverall = kNone;  // with certificate and energies
};

struct Study {
  std::vector<StudyRow> rows;  // in the order of studyRuns(); without those that are left
  StudyRun base, baseSphere;
  std::size_t vertices = 0;        // of the source mesh
  double spacing = 0;              // of one charge: sqrt(area), fraction of the source's diagonal
  std::size_t made = 0, kept = 0;  // of the rows
  std::size_t left = 0;            // runs of other shares, or that the deadline left
  std::vector<std::string> warnings;
};

// The runs of these settings: each list alone, then the grid; each run once, kMostRuns of them at
// most. Throws SettingError.
constexpr std::size_t kMostRuns = 10000;
std::vector<StudyRun> studyRuns(const Solid& source, const StudySettings& settings);

// Need in bytes of making a run, an estimate.
std::uint64_t studyMemory(const StudyRun& run);

// Whether settings.folder has the run.
bool isKept(const BoundaryPair& pair, const StudyRun& run, const StudySettings& settings);

// Called before the first run, with no row, and after each with its row: `done` of `all` are
// finished, taken from the folder or left.
using StudyVisitor = std::function<void(const StudyRow* row, std::size_t done, std::size_t all)>;

// Makes the runs, one after another. A run that is over the limit on memory, or whose charges find
// no place, is a row with a failure. Throws SettingError, FileError (the folder), Cancelled, and
// what the visitor throws: finished runs stay in the folder. Apart from seconds, deterministic for
// a seed and for any number of threads.
Study runStudy(const BoundaryPair& pair, const StudySettings& settings = {},
               const StudyVisitor& visitor = {});

// The figures of a study as the columns of a table.

struct StudyColumn {
  const char* name;   // c_error
  const char* title;  // for people; null where others say as much
  double (*value)(const Study&, const StudyRow&);
  bool ofRun = false;  // known of failed runs too
};

// All but where charges are placed and failures, in order: sources, points, points_per_source,
// s_ratio, c_ratio, o_distance, spacings, r_ratio, c_error and so on; as StudyRow has them, the
// ratios as the paper.
const std::vector<StudyColumn>& studyColumns();

// NaN for what is not known.
double valueOf(const StudyColumn& column, const Study& study, const StudyRow& row);

const char* placementText(const StudyRun& run);  // "offset", "sphere"

// What a study says, in words: which settings are best, and which of the paper's statements hold.

// What a series of runs varies, the others at the study's base.
enum class StudyAxis { sources, collocation, place };

// The rows with figures, ascending in what is varied.
std::vector<StudyRow> studySeries(const Study& study, StudyAxis axis, ChargePlacement placement);

enum class StatementVerdict { holds, partly, fails, unknown };
std::string verdictText(StatementVerdict verdict);  // "holds", "in part", "does not hold", ...

struct StudyStatement {
  std::string text;
  StatementVerdict verdict = StatementVerdict::unknown;
  std::string figures;  // that say so
};

struct StudyFindings {
  std::optional<StudyRow> best;      // of the smallest error at 99% of the fresh points
  std::optional<StudyRow> cheapest;  // of the fewest seconds within kNearlyBest of it
  std::vector<std::string> advice;   // a sentence or two each
  std::vector<StudyStatement> statements;
};

constexpr double kNearlyBest = 1.5;  // times the smallest error

StudyFindings studyFindings(const Study& study);

// "1000 charges at 0.02, 4 points each"; "1000 charges on a sphere of 1.5, 4 points each".
std::string describeRun(const StudyRun& run);

// The same as options of `innermap map`, whose map it then is.
std::string optionsOf(const StudyRun& run, const StudySettings& settings);

}  // namespace innermap
