#include "report/jobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>

#include "core/file.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

using Json = nlohmann::ordered_json;

enum class Engine { lines, slurm, openJd };

Engine engineOf(const std::string& setting, const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".txt") return Engine::lines;
  if (ending == ".sh" || ending == ".sbatch") return Engine::slurm;
  if (ending == ".json" || ending == ".yaml" || ending == ".yml") return Engine::openJd;
  throw SettingError(setting, "'" + path +
                                  "' must end in .txt (a command a line), .sh or .sbatch (Slurm), "
                                  ".json or .yaml (OpenJD)");
}

// As a shell reads it back.
std::string quoted(const std::string& text) {
  constexpr const char* kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,@%";
  if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) return text;
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

// share: written as it is, for the shell or the engine to fill in.
std::string line(const Jobs& jobs, const std::vector<std::string>& command,
                 const std::string& share) {
  std::string out = "cd " + quoted(jobs.folder) + " &&";
  for (const std::string& word : command) out += " " + quoted(word);
  return share.empty() ? out : out + " --share " + share;
}

constexpr double kTimes = 4, kBeside = 60;                // seconds
constexpr double kMemoryTimes = 1.25, kMemoryMore = 200;  // MB

std::uint64_t secondsToAsk(const JobNeed& job) {
  return static_cast<std::uint64_t>(std::ceil(kTimes * job.seconds + kBeside));
}

std::uint64_t minutesToAsk(const JobNeed& job) { return (secondsToAsk(job) + 59) / 60; }

std::uint64_t mebibytesToAsk(const JobNeed& job) {
  constexpr double kMebibyte = 1 << 20, kMegabyte = 1e6;
  return static_cast<std::uint64_t>(std::ceil(
      (kMemoryTimes * static_cast<double>(job.memory) + kMemoryMore * kMegabyte) / kMebibyte));
}

std::string linesText(const Jobs& jobs) {
  std::string out;
  for (std::uint64_t k = 1; k <= jobs.tasks; ++k)
    out += line(jobs, jobs.command, fmt::format("{}/{}", k, jobs.tasks)) + "\n";
  return out;
}

// A line of a script: VARIABLE=$(sbatch ...). after: the variable of the job that comes before.
std::string submission(const std::string& variable, const std::string& name, const JobNeed& need,
                       const std::string& after, const std::string& more,
                       const std::string& command) {
  return fmt::format(
      "{}=$(sbatch --parsable --job-name={}{}{} --requeue --mem={}M --time={} \"$@\" --wrap {})\n",
      variable, quoted(name),
      after.empty() ? "" : fmt::format(" --dependency=afterok:\"${}\"", after), more,
      mebibytesToAsk(need), minutesToAsk(need), quoted(command));
}

std::string slurmText(const Jobs& jobs) {
  const std::string cores = fmt::format(" --cpus-per-task={}", jobs.cores);
  const bool begins = !jobs.first.empty(), joins = !jobs.join.empty();
  std::string out = fmt::format(
      "#!/bin/sh\n"
      "# {} in {} shares, for Slurm: run this file where sbatch is.\n"
      "# A task should take {:.0f} s and {} MB, on {} cores. It asks for {}.\n"
      "# It goes back into the queue when its node fails, and then skips finished work.\n"
      "set -e\n",
      jobs.name, jobs.tasks, jobs.task.seconds, jobs.task.memory / 1'000'000, jobs.cores,
      marginsText());
  if (begins)
    out += submission("first", jobs.name + " first", jobs.beginning, "", cores,
                      line(jobs, jobs.first, ""));
  out += submission("array", jobs.name, jobs.task, begins ? "first" : "",
                    fmt::format(" --array=1-{}{}", jobs.tasks, cores),
                    line(jobs, jobs.command, fmt::format("$SLURM_ARRAY_TASK_ID/{}", jobs.tasks)));
  if (joins)
    out += submission("join", jobs.name + " join", jobs.joining, "array", "",
                      line(jobs, jobs.join, ""));
  if (begins || joins)
    out += fmt::format("echo \"{}array $array{}\"\n", begins ? "first $first, " : "",
                       joins ? ", join $join" : "");
  return out;
}

Json openJdStep(const Jobs& jobs, const JobNeed& need, const std::string& name,
                const std::string& command) {
  Json step{{"name", name}};
  step["hostRequirements"]["amounts"] =
      Json::array({Json{{"name", "amount.worker.memory"}, {"min", mebibytesToAsk(need)}},
                   Json{{"name", "amount.worker.vcpu"}, {"min", jobs.cores}}});
  step["script"]["actions"]["onRun"] = Json{
      {"command", "sh"}, {"args", Json::array({"-c", command})}, {"timeout", secondsToAsk(need)}};
  return step;
}

// In a template "{{" begins a reference.
void requireNoReference(const std::string& setting, const std::string& text, std::size_t allowed) {
  if (const std::size_t at = text.find("{{"); at != std::string::npos && at < allowed)
    throw SettingError(setting, "'{{' in a file's name cannot be written into an OpenJD template");
}

std::string openJdText(const std::string& setting, const Jobs& jobs) {
  Json steps = Json::array();
  const auto add = [&](const JobNeed& need, const std::string& name, const std::string& command) {
    Json step = openJdStep(jobs, need, name, command);
    if (!steps.empty())
      step["dependencies"] = Json::array({Json{{"dependsOn", steps.back()["name"]}}});
    steps.push_back(step);
  };
  const auto addOne = [&](const JobNeed& need, const std::string& name,
                          const std::vector<std::string>& words) {
    if (words.empty()) return;
    const std::string command = line(jobs, words, "");
    requireNoReference(setting, command, command.size());
    add(need, name, command);
  };
  addOne(jobs.beginning, "First", jobs.first);
  const std::string task =
      line(jobs, jobs.command, fmt::format("{{{{Task.Param.Share}}}}/{}", jobs.tasks));
  requireNoReference(setting, task, task.rfind("{{Task.Param"));
  add(jobs.task, "Shares", task);
  const Json share{{"name", "Share"}, {"type", "INT"}, {"range", fmt::format("1-{}", jobs.tasks)}};
  steps.back()["parameterSpace"]["taskParameterDefinitions"] = Json::array({share});
  addOne(jobs.joining, "Join", jobs.join);
  const Json root{
      {"specificationVersion", "jobtemplate-2023-09"}, {"name", jobs.name}, {"steps", steps}};
  return root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string marginsText() {
  return fmt::format("{:g} times the time and {:g} s, {:g} times the memory and {:g} MB", kTimes,
                     kBeside, kMemoryTimes, kMemoryMore);
}

void requireJobsFile(const std::string& setting, const std::string& path) {
  engineOf(setting, path);
}

void writeJobs(const std::string& setting, const std::string& path, const Jobs& jobs) {
  const Engine engine = engineOf(setting, path);
  if (engine == Engine::lines && !jobs.first.empty())
    throw SettingError(setting, "'" + path +
                                    "': lines have no order, and one command must end before the "
                                    "others begin; choose .sh, .sbatch, .json or .yaml");
  std::vector<std::string> words = jobs.command;
  words.insert(words.end(), jobs.first.begin(), jobs.first.end());
  words.insert(words.end(), jobs.join.begin(), jobs.join.end());
  words.push_back(jobs.folder);
  for (const std::string& word : words)
    if (std::any_of(word.begin(), word.end(), [](unsigned char c) { return c < 32 || c == 127; }))
      throw SettingError(setting, "an argument or folder holds a line break or control character");
  const std::string text = engine == Engine::lines   ? linesText(jobs)
                           : engine == Engine::slurm ? slurmText(jobs)
                                                     : openJdText(setting, jobs);
  writeWholeFile(path, [&](std::ostream& file) { file << text; });
  if (engine == Engine::slurm) {
    using std::filesystem::perms;
    std::error_code none;
    std::filesystem::permissions(path, perms::owner_exec | perms::group_exec | perms::others_exec,
                                 std::filesystem::perm_options::add, none);
  }
}

}  // namespace innermap
