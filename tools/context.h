// What a running command is given: progress, limits, timing, a place for messages.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "innermap/core/file.h"
#include "innermap/core/progress.h"
#include "innermap/io/report.h"

namespace innermap::tool {

class TerminalProgress;

// The options that every command has.
struct CommonOptions {
  int threads = 0;
  std::string maxMemory;
  bool dryRun = false;
  std::string report;
  bool quiet = false;
  bool help = false;
};

// A command calls it from one thread; progress() may be used from any.
class Context {
 public:
  Context(const CommonOptions& options, TerminalProgress& progress);
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  Progress* progress() const;

  // For commands that do the same for several things, say frames: which one is under way, shown
  // with the progress. Empty: none.
  void setPart(const std::string& part);

  // Bytes: --max-memory, or 80% of the machine's.
  std::uint64_t maxMemory() const { return maxMemory_; }

  bool dryRun() const { return options_.dryRun; }
  // What --dry-run says: a line for each thing that would be done, and the peak need in bytes (also
  // whether it is over the limit), on stdout.
  void plan(const std::vector<std::string>& lines, std::uint64_t bytes);

  // All that a command writes passes here, before it reads or computes anything. Throws FileError
  // unless a file can be created at `path`; does nothing in a dry run.
  void output(const std::string& path);
  // The same for a folder of files that appear together; not for dry runs.
  PendingFolder outputFolder(const std::string& path);
  // Says so when pictures will have no labels for lack of a font; output() does for .png files.
  void notePictures();

  // Runs `body` and adds its wall time to the report's "seconds" under `stage`.
  void timed(const std::string& stage, const std::function<void()>& body);

  // One line each on stderr (nothing with --quiet), and in the report.
  void note(const std::string& text);     // what was repaired or chosen
  void warning(const std::string& text);  // what makes the result doubtful

  // The command goes on and writes its files, and its report; then the program ends with this line
  // on stderr and exit code 1.
  void failAfterwards(const std::string& text) { failure_ = text; }
  const std::string& failure() const { return failure_; }

  // Results, on stdout. Nothing else goes there.
  void print(const std::string& text);

  // Sections that the command fills; the framework writes it to --report F afterwards.
  Report& report() { return report_; }
  // With peak memory as it now stands; for a command that writes a report file of its own.
  const Report& finishedReport();

 private:
  void say(const std::string& kind, const std::string& text);

  const CommonOptions& options_;
  TerminalProgress& progress_;
  std::uint64_t maxMemory_ = 0;
  Report report_;
  std::string failure_;
};

}  // namespace innermap::tool
