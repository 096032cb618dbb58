// What a study is made of: its settings, its runs, one fit each, and what became of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "innermap/boundary/fit_map.h"
#include "innermap/core/setting.h"
#include "innermap/evaluate/energy.h"

namespace innermap {

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
};

// Without the lists and the folder.
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

}  // namespace innermap
