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
  std::vector<std::string> command;  // of a task, to which --share K/N is added
  std::vector<std::string> join;     // once all tasks are done; may be empty
  std::uint64_t tasks = 1;
  JobNeed task, joining;
  std::uint64_t cores = 1;  // that a task uses
};

// What engines are told is so many times what is expected, beside a minute, and 200 MB: estimates
// of time are out by up to three, those of memory are mostly too large.
constexpr double kTimeMargin = 4, kMemoryMargin = 1.25;

// By the ending of `path`: a line of shell a task (.txt: GNU parallel, OpenCue's cuecmd, PDG); a
// shell script that submits a job array to Slurm, and the join once all of it is done
// (.sh, .sbatch); an Open Job Description template, 2023-09, as JSON, which is YAML too (.json,
// .yaml, .yml). Whole or not at all. Throws SettingError naming `setting` for another ending and
// for arguments with line breaks, FileError.
void writeJobs(const std::string& setting, const std::string& path, const Jobs& jobs);

// Throws SettingError as writeJobs() for another ending.
void requireJobsFile(const std::string& setting, const std::string& path);

}  // namespace innermap
