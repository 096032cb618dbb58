// The verdict that runs end with: whether the result is good enough, by thresholds that are
// settings, and what to try if not.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/evaluate/grids.h"
#include "innermap/fit/fit_map.h"
#include "innermap/fit/frame_fitter.h"
#include "innermap/transfer/carry.h"
#include "report/report.h"

namespace innermap {

struct VerdictFinding {
  ReportFinding finding;
  bool told = false;  // another message has said so: no warning is due
};

struct Verdict {
  std::vector<VerdictFinding> findings;
  // What the report says beside them, by section.
  std::vector<std::pair<std::string, Figures>> figures;
};

struct VerdictSettings {
  double maxFolded = 1e-3;  // share of the inside
  // Share of the inside. The error that counts is that of 99% of the boundary, so the worst
  // hundredth of what lies next to it may be out.
  double maxOutside = 2e-3;
  std::uint64_t maxCrossings = 0;  // pairs of triangles of the target
};
// frames: of targets that are frames, whose crossings are not looked at.
std::vector<Setting> describe(VerdictSettings& settings, bool frames = false);

// How a map came to be, which decides what to try.
enum class MapOrigin { related, laidOn, file };

// Boundary, folds, outside and self-intersections of a map. grids: what voxels tell of it, or null.
// fitted: as it was, if known.
Verdict judgeMap(const MappedSolid& mapped, const SolidGrids* grids,
                 const VerdictSettings& settings, MapOrigin origin,
                 const FitMapSettings& fitted = {});

// Boundary, folds and outside of the frames that were fitted, against the tolerance: those that
// miss it stand in the report's frames.missed. Empty without frames.
struct JudgedFrame {
  std::int64_t number = 0;
  double p99 = 0, folded = 0, outside = 0;
  bool misses(double tolerance) const { return !(p99 <= tolerance); }
};
JudgedFrame judgedFrame(const NumberedFit& frame);
Verdict judgeFrames(const std::vector<JudgedFrame>& frames, double tolerance,
                    const VerdictSettings& settings);

// Of a texture's fit, in units of its values. Empty where nothing was measured.
Verdict judgeTexture(const BoundaryError& error, double tolerance);

struct CarryVerdictSettings {
  double maxDensity = 6;  // times: a fold's three layers, each twice as dense as all on average
  double maxLost = 0.1;   // share of the inside
};
std::vector<Setting> describe(CarryVerdictSettings& settings);

// growth: the most that a density grows. volumes: the solid's that it goes to by that which it
// comes from. where: "" or "in frame 12 ".
struct JudgedDensity {
  std::string grid, where;
  double growth = 0, volumes = 1;
};
Verdict judgeDensity(const JudgedDensity& density, const CarryVerdictSettings& settings);

Verdict judgeResampling(const ResamplingFigures& figures, const CarryVerdictSettings& settings);

}  // namespace innermap
