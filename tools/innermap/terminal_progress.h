// Progress on stderr: a bar on a terminal, else a plain line from time to time, or one a stage.
#pragma once

#include <chrono>
#include <mutex>
#include <set>
#include <string>

#include "innermap/core/run.h"
#include "job_clock.h"

namespace innermap::tool {

class TerminalProgress : public RunContext {
 public:
  enum class Style { none, rare, lines, bar };

  // lines when verbose, else bar when stderr is a terminal that can move its cursor.
  static Style styleFor(bool quiet, bool verbose);

  explicit TerminalProgress(Style style) : style_(style) {}
  ~TerminalProgress() override { clear(); }

  void report(std::string_view stage, double fraction) override;

  // What stands before each stage from now on: which of several parts is under way. As plain lines
  // each part is told once, not its stages.
  void setPart(const std::string& part);

  // What the whole job consists of: there is then one bar for it, with the time that is left.
  void expect(std::vector<JobPhase> phases);

  // The job's stages so far.
  std::vector<JobPhaseTaken> taken() const;
  // As plain lines: the longest of them.
  void sayLongest() const;

  // Takes the bar away, so that a message can be written.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  double now() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  std::string label(std::string_view stage) const;
  void drawBar(std::string_view stage, double fraction);
  void writeLine(std::string_view stage, double fraction);

  const Style style_;
  mutable std::mutex mutex_;
  const Clock::time_point start_ = Clock::now();
  JobClock job_;
  Clock::time_point last_{};
  std::string part_;
  std::set<std::string> seen_;  // stages that have had their line
  bool drawn_ = false;          // a bar stands on the terminal
};

}  // namespace innermap::tool
