// What a share of a run tells of itself and of each frame: see report/parts.h.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/figure.h"
#include "core/frame_files.h"

namespace innermap {

// In their order. NaN stands for what is not known.
using PartValues = std::vector<std::pair<std::string, FigureValue>>;

// What the parts of a run have in common.
struct PartRun {
  std::string command, version;
  PartValues settings;            // of the command, without those that change no result
  std::string inputs;             // fingerprints of what is read beside the frames
  std::vector<FrameFile> frames;  // all of the run, ascending

  // Not in the fingerprint: how the first worker was called, and what it found for all.
  PartValues reported;  // all settings, as the report of a run without --share has them
  std::vector<std::string> commandLine;
  std::string date;
  PartValues figures;  // of the report, with their sections
  PartValues values;   // of the command's own
  std::vector<std::string> notes, warnings;
};

// What the parts of a run are of: "frame" or, of a volume that is one in the end, "block".
std::string unitOf(const PartRun& run);

// Of one of them.
struct Part {
  std::int64_t frame = 0;  // its number
  std::string input;       // the frame's fingerprint; empty where it cannot be read
  std::string broken;      // why there is no result, or empty
  PartValues values;
  std::vector<std::string> warnings;

  // May differ from worker to worker.
  std::string host, code;      // the machine; the kind of vector code
  double seconds = 0;          // for the frame
  double setup = 0;            // of the worker, before its first frame
  std::uint64_t memory = 0;    // its peak so far, bytes
  std::uint64_t restarts = 0;  // of the worker's task, as far as the engine tells
  std::uint64_t failures = 0;  // not in the file: parts of the same frame that are broken
  std::vector<std::pair<std::string, double>> stageSeconds;  // of the report, for this frame
};

}  // namespace innermap
