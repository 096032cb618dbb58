// A run in shares as the jobs of an engine: a file for Slurm, OpenJD, or whatever takes commands.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace innermap {

// What a job is expected to take.
struct JobNeed {
  double seconds = 0;
  std::uint64_t memory = 0;  // bytes
};

struct Jobs {
  std::string name;                  // "innermap sequence"
  std::string folder;                // where commands run
  std::vector<std::string> first;    // before all tasks; may be empty
  std::vector<std::string> command;  // of a task, to which --share K/N is added
  std::vector<std::string> join;     // once all tasks are done; may be empty
  std::uint64_t tasks = 1;
  JobNeed beginning, task, joining;  // of `first`, a task, `join`
  std::uint64_t cores = 1;           // that a task uses
};

// What engines are told of what is expected, "4 times the seconds, and a minute; ...": estimates of
// time are out by up to three, those of memory are mostly too large.
std::string marginsText();

// By the ending of `path`: a line of shell a task (.txt: GNU parallel, OpenCue's cuecmd, PDG); a
// shell script that submits a job array to Slurm, and the join once all of it is done
// (.sh, .sbatch); an Open Job Description template, 2023-09, as JSON, which is YAML too (.json,
// .yaml, .yml). Whole or not at all. Throws SettingError naming `setting` for another ending, for
// arguments with line breaks, and for a `first` where lines have no order; FileError.
void writeJobs(const std::string& setting, const std::string& path, const Jobs& jobs);

// Throws SettingError as writeJobs() for another ending.
void requireJobsFile(const std::string& setting, const std::string& path);

}  // namespace innermap
