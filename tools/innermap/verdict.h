// The verdict that runs end with: whether the result is good enough, by thresholds that are
// settings, and what to try if not. Each of these functions adds to it by Context::judge.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "innermap/evaluate/grids.h"
#include "innermap/fit/fit_map.h"
#include "innermap/fit/frame_fitter.h"
#include "innermap/transfer/carry.h"

namespace innermap::tool {

struct VerdictOptions {
  double maxFolded = 1e-3;  // share of the inside
  // Share of the inside. The error that counts is that of 99% of the boundary, so the worst
  // hundredth of what lies next to it may be out.
  double maxOutside = 2e-3;
  std::uint64_t maxCrossings = 0;  // pairs of triangles of the target
};

// --warn-folded, --warn-outside, and --warn-crossings unless the targets are frames.
void addVerdictOptions(Command& command, VerdictOptions& options, bool frames = false);

// How a map came to be, which decides what to try.
enum class MapOrigin { related, laidOn, file };

// Boundary, folds, outside and self-intersections of a map; grids: what voxels tell of it, or null.
void judgeMap(const MappedSolid& mapped, const SolidGrids* grids, const VerdictOptions& options,
              MapOrigin origin, Context& context);

// Boundary, folds and outside of the frames that were fitted, against the tolerance: those that
// miss it stand in the report's frames.missed.
struct JudgedFrame {
  std::int64_t number = 0;
  double p99 = 0, folded = 0, outside = 0;
  bool misses(double tolerance) const { return !(p99 <= tolerance); }
};
void judgeFrames(const std::vector<JudgedFrame>& frames, double tolerance,
                 const VerdictOptions& options, Context& context);

// Of the texture's fit, in units of its values.
void judgeTexture(const BoundaryError& error, double tolerance, Context& context);

struct CarryVerdictOptions {
  double maxDensity = 6;  // times: a fold's three layers, each twice as dense as all on average
  double maxLost = 0.1;   // share of the inside
};
void addCarryVerdictOptions(Command& command, CarryVerdictOptions& options);

// growth: the most that a density grows. volumes: the solid's that it goes to by that which it
// comes from. where: "" or "in frame 12 ".
struct JudgedDensity {
  std::string grid, where;
  double growth = 0, volumes = 1;
};
void judgeDensity(const JudgedDensity& density, const CarryVerdictOptions& options,
                  Context& context);

void judgeResampling(const ResamplingFigures& figures, const CarryVerdictOptions& options,
                     Context& context);

}  // namespace innermap::tool
