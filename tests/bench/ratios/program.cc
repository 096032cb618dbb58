#include "program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "innermap/core/error.h"

extern char** environ;

namespace innermap::bench {
namespace {

namespace fs = std::filesystem;

double secondsOf(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

// Of a file, or of all files in a folder; 0 if there is none.
double bytesAt(const fs::path& path) {
  std::error_code none;
  if (fs::is_regular_file(path, none)) return static_cast<double>(fs::file_size(path));
  double sum = 0;
  if (fs::is_directory(path, none))
    for (const auto& entry : fs::recursive_directory_iterator(path)) sum += bytesAt(entry);
  return sum;
}

}  // namespace

Finished runProcess(const std::vector<std::string>& words, const std::string& output) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  Finished out;
  Stopwatch watch;
  pid_t child = 0;
  const int failed =
      posix_spawn(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed) throw Error(words[0] + ": cannot be run; check its path");
  int status = 0;
  rusage used{};
  if (wait4(child, &status, 0, &used) != child || !WIFEXITED(status))
    throw Error(words[0] + " " + words[1] + ": did not come to its end");
  out.seconds = watch.lap();
  out.cpuSeconds = secondsOf(used.ru_utime) + secondsOf(used.ru_stime);
  out.exitCode = WEXITSTATUS(status);
  return out;
}

ProgramRun runProgram(const std::vector<std::string>& command, const Options& options) {
  const std::string report = options.scratch + "/report.json";
  std::remove(report.c_str());
  std::vector<std::string> words{options.program};
  words.insert(words.end(), command.begin(), command.end());
  words.insert(words.end(),
               {"--quiet", "--threads", std::to_string(options.threads), "--report", report});
  ProgramRun run{runProcess(words), Json(), 0};
  for (const std::string& word : command) run.bytes += bytesAt(word);
  std::ifstream file(report);
  run.report = Json::parse(file, nullptr, false);
  if (!run.report.is_object())
    throw Error(words[0] + " " + words[1] + ": left no report, exit code " +
                std::to_string(run.exitCode));
  return run;
}

Json ProgramRun::costs(const Options& options, Work known) const {
  known.bytes += bytes;
  Json out{{"process s", seconds},
           {"cpu s", cpuSeconds},
           {"peak GB", 1e-9 * report["peak_memory_bytes"].get<double>()}};
  out.update(besideLimit(options.limits, known, seconds));
  return out;
}

double secondsToWeights(const Json& report) {
  double sum = 0;
  for (const auto& [stage, seconds] : report["seconds"].items())
    if (stage == "read" || stage == "check" || stage == "solid" || stage == "sample" ||
        stage == "fit")
      sum += seconds.get<double>();
  return sum;
}

}  // namespace innermap::bench
