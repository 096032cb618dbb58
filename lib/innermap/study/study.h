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
#include <string>
#include <vector>

#include "innermap/study/study_run.h"

namespace innermap {

struct Study {
  std::vector<StudyRow> rows;  // in the order of studyRuns(); without those that are left
  StudyRun base, baseSphere;
  std::size_t vertices = 0;        // of the source mesh
  double spacing = 0;              // of one charge: sqrt(area), fraction of the source's diagonal
  std::size_t made = 0, kept = 0;  // of the rows
  std::size_t left = 0;            // runs that the deadline left for another time
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

}  // namespace innermap
