// Shares of the frames or blocks of a run: what workers on a farm make, and `join` puts together.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "frame_loop.h"
#include "report/parts.h"

namespace innermap::tool {

struct ShareOptions {
  std::string share;  // empty: all
  std::string jobs;   // a file to write, or empty
  std::optional<std::uint64_t> tasks;
};

// --share, --jobs, --tasks. units: "frames"; results: what becomes of a share, a sentence.
void addShareOptions(Command& command, ShareOptions& options, const std::string& units,
                     const std::string& results);

// --jobs and --tasks alone: of commands that are no share themselves.
void addJobsOptions(Command& command, ShareOptions& options);

// Whether other processes make parts of the run, too.
bool inShares(const ShareOptions& options);

// Whether --jobs is given. Throws UsageError, SettingError for what does not go with it.
bool writesJobs(const ShareOptions& options, Context& context);

// A run that is to be made in shares.
struct ShareRun {
  std::size_t units = 0;               // frames, or blocks
  std::vector<JobPhase> phases;        // of the whole, the last of them the units'
  std::uint64_t bytes = 0;             // of a share, beyond what the process has by now
  std::string joined = {};             // the folder that `join` is given; empty: nothing to join
  std::vector<JobPhase> joining = {};  // of the join; empty: it needs what a share does, or less
  std::uint64_t joiningBytes = 0;      // as bytes
  std::string unit = "frame";
  bool sameCommand = false;  // without --share it joins
  // Words of the command of a share; empty: this one. And of one before all of them, if any.
  std::vector<std::string> command = {}, first = {};
  std::vector<JobPhase> beginning = {};  // of `first`
  std::uint64_t beginningBytes = 0;
};

// What --jobs writes in place of the run.
void writeShareJobs(const ShareOptions& options, const ShareRun& run, Context& context);

// Cuts frames.wanted down to those of the share, and returns it with its numbers, "3/40". All stay
// where `share` is empty.
std::string cutToShare(const std::string& share, Frames& frames);

// A worker's side of it. Its output has no report of the run, but a folder parts/.
class FrameShare {
 public:
  // Cuts frames.wanted down to those of the share that are not finished yet: those that have no
  // part or, where `outputs` is given, no whole file. inputs: fingerprints of what is read
  // beside frames. Throws SettingError, FileError, DataError (parts of another run).
  FrameShare(const std::string& share, const std::string& folder, const std::string& inputs,
             const FramePattern* outputs, Frames& frames, Context& context);

  // After all that frames have in common is made, and told to the context.
  void begin(const PartValues& values);

  // After a frame. values: its figures, of a good one.
  void ended(const FrameResult& result, PartValues values);

  // After the last one: what is left is a failure, so that an engine starts the task again.
  void conclude(const std::vector<FrameResult>& results);

 private:
  Context& context_;
  const Frames& frames_;
  PartRun run_;
  std::vector<std::string> inputs_;  // by index in frames.all; of those of the share
  std::optional<PartFolder> folder_;
  std::optional<FramePattern> outputs_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double setup_ = 0;
  std::size_t finished_ = 0, warnings_ = 0;
  StageSeconds seconds_;  // of the report, before the frame

  bool isMade(std::int64_t frame, const std::string& input) const;
  const std::string& inputOf(const FrameFile& file) const;
};

// Whether the file that belongs to a part is there, whole, by its size.
bool hasOutput(const Part& part, const std::string& path);
// Throws DataError where it is not what was written, by its content.
void requireOutput(const Part& part, const std::string& path);

std::string hostName();  // of this machine

}  // namespace innermap::tool
