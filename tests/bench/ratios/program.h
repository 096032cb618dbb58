// The innermap program in a process of its own, so that its peak memory is its own too.
#pragma once

#include <string>
#include <vector>

#include "section.h"

namespace innermap::bench {

struct Finished {
  int exitCode = 0;
  double seconds = 0, cpuSeconds = 0;  // of the whole process: wall time, processor time
};

// Runs a program; its standard output goes into a file. Throws innermap::Error if it cannot be
// started or is ended by a signal.
Finished runProcess(const std::vector<std::string>& words, const std::string& output = "/dev/null");

struct ProgramRun : Finished {
  Json report;       // its --report
  double bytes = 0;  // of the files that the command names, read and written

  // The columns {"process s", "cpu s", "peak GB", "limit s", "of limit %"}. The limit is that of
  // the files' bytes and of what is known of the work beside.
  Json costs(const Options& options, Work known = {}) const;
};

// Runs `innermap COMMAND...` with the options' threads. Throws as runProcess, and if it leaves no
// report.
ProgramRun runProgram(const std::vector<std::string>& command, const Options& options);

// Seconds of the report's stages up to the weights: reading, checking, placing, solving.
double secondsToWeights(const Json& report);

}  // namespace innermap::bench
