// The frames of a sequence and how they are fitted: what `sequence` and `deform` share.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "core/frame_files.h"
#include "innermap/fit/frame_fitter.h"
#include "innermap/mesh/mesh_file.h"
#include "jobs/frames_job.h"
#include "report/verdict.h"

namespace innermap::tool {

struct FrameOptions {
  std::vector<std::string> files;
  std::string ranges, usd;
  AnimationSettings animation;
  FrameFitterSettings fitting;
  double tolerance = kUsualTolerance;  // that frames are judged by
  VerdictSettings verdict;
};

// The argument FRAMES, which must be the last one.
void addFrameArgument(Command& command, FrameOptions& options);
void addFrameOptions(Command& command, FrameOptions& options);

struct Frames {
  std::shared_ptr<const FrameSource> source;  // none of what is cut up and is no animation
  std::string unit = "frame";                 // what one of them is called
  std::vector<std::uint64_t> weights;         // of all, how long each takes; empty: all alike
  AnimationSettings animation;
  std::vector<FrameFile> all;       // the source's, ascending
  std::vector<std::size_t> wanted;  // of all, those that --frames chooses
  bool share = false;               // wanted are some of a run's that is cut up
};

// Files without a number that a pattern or folder holds are noted, but for the rest pose. Throws
// FileError, SettingError.
Frames listFrames(const FrameOptions& options, const std::string& rest, Context& context);

// options.usd refers to all frames. Throws UsageError where they are made in shares.
void requireUsdOfAll(const FrameOptions& options, bool inShares);
// Tells of options.usd. Call it before anything is read.
void announceUsd(const FrameOptions& options, Context& context);
// Writes it, of those of the frames wanted that are there.
void writeUsd(const FrameOptions& options, const FramePattern& pattern, const Frames& frames,
              Context& context);

// The output of each of the frames wanted.
std::vector<std::string> framePaths(const FramePattern& pattern, const Frames& frames);

// The rest pose of these frames; fills the report's "source". Throws DataError where they are of
// another mesh.
SourceBoundary readRest(const std::string& rest, const Frames& frames, Context& context);

// Its fitter; fills the report's "solve".
FrameFitter makeFrameFitter(SourceBoundary source, const FrameFitterSettings& settings,
                            Context& context);

// Told once in a run: from which frame on its parts move so.
void noteJumps(std::int64_t frame, const std::string& jumps, Context& context);

// Reads and fits frames.all as they are asked for. All three must outlive the result.
FrameFits makeFrameFits(const FrameFitter& fitter, const Frames& frames, Context& context);

// "fit 8000 charges to 24000 boundary points for 48 frames, 1 to 48", for --dry-run.
std::string framesPlan(const FrameFitterSettings& settings, const Frames& frames);
// "carry smoke.vdb to out/a.0001.vdb to out/a.0048.vdb", likewise.
std::string carryPlan(const std::string& input, const std::string& output, const Frames& frames);

}  // namespace innermap::tool
