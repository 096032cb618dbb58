// The innermap program in a process of its own, so that its peak memory is its own too.
#pragma once

#include <string>
#include <vector>

#include "section.h"

namespace innermap::bench {

struct ProgramRun {
  int exitCode = 0;
  double seconds = 0;  // of the whole process
  Json report;         // its --report
};

// Runs `innermap COMMAND...` with the options' threads; what it says goes nowhere. Throws
// innermap::Error when it cannot be started, is ended by a signal or leaves no report.
ProgramRun runProgram(const std::vector<std::string>& command, const Options& options);

// Seconds of the report's stages up to the weights: reading, checking, placing, solving.
double secondsToWeights(const Json& report);

// Peak resident size.
double gigabytes(const Json& report);

}  // namespace innermap::bench
