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

std::uint64_t secondsToAsk(const JobNeed& job) {
  return 60 + static_cast<std::uint64_t>(std::ceil(kTimeMargin * job.seconds));
}

std::uint64_t minutesToAsk(const JobNeed& job) { return (secondsToAsk(job) + 59) / 60; }

std::uint64_t mebibytesToAsk(const JobNeed& job) {
  constexpr double kMebibyte = 1 << 20, kBeside = 200e6;
  return static_cast<std::uint64_t>(
      std::ceil((kMemoryMargin * static_cast<double>(job.memory) + kBeside) / kMebibyte));
}

std::string linesText(const Jobs& jobs) {
  std::string out;
  for (std::uint64_t k = 1; k <= jobs.tasks; ++k)
    out += line(jobs, jobs.command, fmt::format("{}/{}", k, jobs.tasks)) + "\n";
  return out;
}

std::string slurmText(const Jobs& jobs) {
  std::string out = fmt::format(
      "#!/bin/sh\n"
      "# {} in {} shares, for Slurm: run this file where sbatch is.\n"
      "# A task should take {:.0f} s and {} MB. It asks for {:g} times the time and a minute,\n"
      "# for {:g} times the memory and 200 MB, and for {} cores. It goes back into the queue when\n"
      "# its node fails, and then skips finished work.\n"
      "set -e\n"
      "array=$(sbatch --parsable --job-name={} --array=1-{} --requeue --cpus-per-task={} --mem={}M "
      "--time={} \"$@\" --wrap {})\n",
      jobs.name, jobs.tasks, jobs.task.seconds, jobs.task.memory / 1'000'000, kTimeMargin,
      kMemoryMargin, jobs.cores, quoted(jobs.name), jobs.tasks, jobs.cores,
      mebibytesToAsk(jobs.task), minutesToAsk(jobs.task),
      quoted(line(jobs, jobs.command, fmt::format("$SLURM_ARRAY_TASK_ID/{}", jobs.tasks))));
  if (!jobs.join.empty())
    out += fmt::format(
        "join=$(sbatch --parsable --job-name={} --dependency=afterok:\"$array\" --requeue "
        "--mem={}M --time={} \"$@\" --wrap {})\n"
        "echo \"array $array, join $join\"\n",
        quoted(jobs.name + " join"), mebibytesToAsk(jobs.joining), minutesToAsk(jobs.joining),
        quoted(line(jobs, jobs.join, "")));
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
std::string openJdText(const std::string& setting, const Jobs& jobs) {
  const std::string task =
      line(jobs, jobs.command, fmt::format("{{{{Task.Param.Share}}}}/{}", jobs.tasks));
  const std::string join = line(jobs, jobs.join, "");
  const auto braces = [](const std::string& text, std::size_t allowed) {
    return text.find("{{") != std::string::npos && text.find("{{") < allowed;
  };
  if (braces(task, task.rfind("{{Task.Param")) || braces(join, join.size()))
    throw SettingError(setting, "'{{' in a file's name cannot be written into an OpenJD template");
  Json frames = openJdStep(jobs, jobs.task, "Shares", task);
  const Json share{{"name", "Share"}, {"type", "INT"}, {"range", fmt::format("1-{}", jobs.tasks)}};
  frames["parameterSpace"]["taskParameterDefinitions"] = Json::array({share});
  Json steps = Json::array({frames});
  if (!jobs.join.empty()) {
    Json last = openJdStep(jobs, jobs.joining, "Join", join);
    last["dependencies"] = Json::array({Json{{"dependsOn", "Shares"}}});
    steps.push_back(last);
  }
  const Json root{
      {"specificationVersion", "jobtemplate-2023-09"}, {"name", jobs.name}, {"steps", steps}};
  return root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

void requireJobsFile(const std::string& setting, const std::string& path) {
  engineOf(setting, path);
}

void writeJobs(const std::string& setting, const std::string& path, const Jobs& jobs) {
  const Engine engine = engineOf(setting, path);
  std::vector<std::string> words = jobs.command;
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
