#include "program.h"

#include <spawn.h>
#include <sys/wait.h>

#include <cstdio>
#include <fstream>
#include <sstream>

#include "innermap/core/error.h"

extern char** environ;

namespace innermap::bench {
namespace {

int runSilently(const std::vector<std::string>& words) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", 1, 0);
  pid_t child = 0;
  const int failed =
      posix_spawn(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed) throw Error(words[0] + ": cannot be run; give its path with --program");
  int status = 0;
  if (waitpid(child, &status, 0) != child || !WIFEXITED(status))
    throw Error(words[0] + " " + words[1] + ": did not come to its end");
  return WEXITSTATUS(status);
}

}  // namespace

ProgramRun runProgram(const std::vector<std::string>& command, const Options& options) {
  const std::string report = options.scratch + "/report.json";
  std::remove(report.c_str());
  std::vector<std::string> words{options.program};
  words.insert(words.end(), command.begin(), command.end());
  words.insert(words.end(),
               {"--quiet", "--threads", std::to_string(options.threads), "--report", report});
  ProgramRun run;
  Stopwatch watch;
  run.exitCode = runSilently(words);
  run.seconds = watch.lap();
  std::ifstream file(report);
  std::ostringstream text;
  text << file.rdbuf();
  run.report = Json::parse(text.str(), nullptr, false);
  if (!run.report.is_object())
    throw Error(words[0] + " " + words[1] + ": left no report, exit code " +
                std::to_string(run.exitCode));
  return run;
}

double secondsToWeights(const Json& report) {
  double sum = 0;
  for (const auto& [stage, seconds] : report["seconds"].items())
    if (stage == "read" || stage == "check" || stage == "solid" || stage == "sample" ||
        stage == "fit")
      sum += seconds.get<double>();
  return sum;
}

double gigabytes(const Json& report) { return 1e-9 * report["peak_memory_bytes"].get<double>(); }

}  // namespace innermap::bench
