// The frames of a sequence and how they are fitted: what `sequence` and `deform` share.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "innermap/boundary/frame_fitter.h"
#include "innermap/core/frame_files.h"

namespace innermap::tool {

struct FrameOptions {
  std::vector<std::string> files;
  std::string ranges;
  std::uint64_t sources = 8000;
  std::optional<std::uint64_t> collocation;
  std::optional<double> distance;  // fraction of the rest's diagonal
  std::uint64_t seed = 1;
};

// The argument FRAMES, which must be the last one.
void addFrameArgument(Command& command, FrameOptions& options);
void addFrameOptions(Command& command, FrameOptions& options);

struct Frames {
  std::vector<FrameFile> all;       // ascending
  std::vector<std::size_t> wanted;  // of all, those that --frames chooses
};

// Files without a number that a pattern or folder holds are noted, but for the rest pose. Throws
// FileError, SettingError.
Frames listFrames(const FrameOptions& options, const std::string& rest, Context& context);

FrameFitterSettings frameFitterSettings(const FrameOptions& options, const Context& context);

// Throws MemoryError, with the largest --sources that would fit beside `others` bytes, when the
// need of all together is over the limit.
void requireFrameMemory(const FrameFitterSettings& settings, std::uint64_t others);

}  // namespace innermap::tool
