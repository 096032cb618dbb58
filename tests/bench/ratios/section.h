// The sections of innermap_ratios, each in a file of its own.
#pragma once

#include <string>
#include <vector>

#include "limits.h"

namespace innermap::bench {

struct Options {
  std::string models;   // folder of the test models
  std::string program;  // innermap, for what is timed from mesh file to map file
  std::string scratch;  // folder for files that come and go
  int threads = 2;
  Limits limits;       // of these threads
  bool quick = false;  // sizes that take seconds in all: shows that it runs, not how fast

  std::string model(const std::string& name) const { return models + "/" + name; }
};

using Tables = std::vector<Json>;

Tables placing(const Options& options);     // time before the fit: reading, checking, sampling
Tables sums(const Options& options);        // hierarchical beside direct sums
Tables solve(const Options& options);       // uniform shells; the dense solver beside them
Tables tolerance(const Options& options);   // sources placed where the error is
Tables poisson(const Options& options);     // OpenVDB's Poisson solver beside our whole way
Tables sequence(const Options& options);    // frames after the first
Tables transfer(const Options& options);    // volumes pushed and pulled
Tables correspond(const Options& options);  // surfaces never related, one onto another
Tables levelset(const Options& options);    // OpenVDB's meshToVolume beside ours
Tables jobs(const Options& options);        // the program's main jobs, all files

}  // namespace innermap::bench
