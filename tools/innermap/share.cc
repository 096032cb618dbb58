#include "share.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <sstream>

#include "command_words.h"
#include "core/file.h"
#include "core/share.h"
#include "innermap/core/memory.h"
#include "innermap/core/version.h"
#include "report/jobs.h"
#include "run_record.h"

namespace innermap::tool {
namespace {

constexpr const char* kShare = "--share";
constexpr const char* kJobs = "--jobs";
constexpr const char* kTasks = "--tasks";

// Change no result, or where it goes.
bool decides(const std::string& setting) {
  for (const char* other : {"share", "jobs", "tasks", "output", "max_time", "force"})
    if (setting == other) return false;
  return true;
}

FigureValue partValue(const ReportValue& value) {
  return std::visit([](const auto& v) -> FigureValue { return v; }, value);
}

// This program, by its name where that is found.
std::string programName() {
  namespace fs = std::filesystem;
  std::error_code failed;
  const fs::path own = fs::read_symlink("/proc/self/exe", failed);
  if (failed) return "innermap";
  std::istringstream folders(environmentVariable("PATH").value_or(""));
  for (std::string folder; std::getline(folders, folder, ':');)
    if (std::error_code none; fs::equivalent(fs::path(folder) / "innermap", own, none))
      return "innermap";
  return own.string();
}

// Each takes at least a minute, and as long as setting up, so that this is half of all at most.
std::uint64_t usualTasks(double setup, double perFrame, std::size_t frames) {
  constexpr double kLeast = 60, kMost = 1000;  // seconds; tasks, as many as Slurm takes as it comes
  const double least = std::max(kLeast, setup);
  const double most = std::min(kMost, static_cast<double>(frames));
  return static_cast<std::uint64_t>(
      std::clamp(std::floor(perFrame * static_cast<double>(frames) / least), 1.0, most));
}

PartRun runOf(const std::string& inputs, const Frames& frames, const Report& report) {
  PartRun run;
  run.command = report.command;
  run.version = versionText();
  run.inputs = inputs;
  for (const std::size_t index : frames.wanted) run.frames.push_back(frames.all[index]);
  run.commandLine = without(report.run->commandLine, {kShare});
  run.date = report.run->date;
  for (const auto& [name, value] : report.run->settings) {
    const bool isShare = name == settingKey(kShare);
    run.reported.emplace_back(
        name, isShare ? std::numeric_limits<double>::quiet_NaN() : partValue(value));
    if (decides(name)) run.settings.emplace_back(name, partValue(value));
  }
  return run;
}

constexpr const char* kOutput = "output";  // the fingerprint of a frame's file

}  // namespace

void addShareOptions(Command& command, ShareOptions& options, const std::string& units,
                     const std::string& results) {
  command.group("machines");
  command
      .option(kShare, "K/N", &options.share,
              "make only share K of N of the " + units +
                  ", for example 3/40. auto: take both numbers from Slurm's job array or from "
                  "OpenCue. " +
                  results)
      .advanced();
  addJobsOptions(command, options);
}

void addJobsOptions(Command& command, ShareOptions& options) {
  command
      .option(
          kJobs, "FILE", &options.jobs,
          "compute nothing; write the run as jobs for a farm. .txt: a command on each line "
          "(GNU parallel, cuecmd, PDG); .sh or .sbatch: a script that submits a job array and "
          "the join to Slurm; .json or .yaml: an OpenJD template. Of the time and memory that a "
          "run is expected to take, jobs ask for " +
              marginsText())
      .advanced();
  command.option(kTasks, "N", &options.tasks, "number of shares for --jobs")
      .range(1, static_cast<double>(Share::kMost))
      .defaults("as many as take a minute or more each")
      .advanced();
}

bool writesJobs(const ShareOptions& options, Context& context) {
  if (options.jobs.empty()) {
    if (options.tasks) throw UsageError("--tasks: is for --jobs; leave it out");
    return false;
  }
  if (!options.share.empty())
    throw UsageError("--jobs: cuts the run into shares itself; leave out --share");
  if (context.page()) throw UsageError("--html: jobs make no page; give --html to innermap join");
  requireJobsFile(kJobs, options.jobs);
  return true;
}

void writeShareJobs(const ShareOptions& options, const ShareRun& run, Context& context) {
  const double units = static_cast<double>(run.units), perUnit = run.phases.back().seconds / units;
  const double setup = totalSeconds(run.phases) - run.phases.back().seconds;
  Jobs jobs;
  jobs.tasks = std::min<std::uint64_t>(
      options.tasks.value_or(usualTasks(setup, perUnit, run.units)), run.units);
  const ReportRun& told = *context.report().run;
  jobs.name = "innermap " + context.report().command;
  jobs.folder = std::filesystem::current_path().string();
  const CommandLine whole = without(told.commandLine, {kJobs, kTasks});
  jobs.first = run.first;
  jobs.command = run.command.empty() ? without(whole, optionsOfTheWhole()) : run.command;
  if (!run.joined.empty())
    jobs.join = handedOn(whole, {"innermap", "join", run.joined}, true);
  else if (run.sameCommand)
    jobs.join = whole;
  else if (jobs.command.size() < whole.size())
    throw UsageError(
        fmt::format("{}: are of the whole run, and no job of {} ends it; leave them out",
                    fmt::join(optionsOfTheWhole(), " and "), context.report().command));
  for (CommandLine* line : {&jobs.first, &jobs.command, &jobs.join})
    if (!line->empty()) line->front() = programName();
  jobs.beginning = {totalSeconds(run.beginning), processMemory(run.beginningBytes)};
  jobs.task = {setup + perUnit * std::ceil(units / static_cast<double>(jobs.tasks)),
               processMemory(run.bytes)};
  jobs.joining = jobs.task;
  if (!run.joining.empty())
    jobs.joining = {totalSeconds(run.joining), processMemory(run.joiningBytes)};
  jobs.cores = static_cast<std::uint64_t>(told.threads);
  const std::string text =
      fmt::format("{} share{} of {} {}{} to {}: about {:.0f} s and {} each", jobs.tasks,
                  jobs.tasks == 1 ? "" : "s", run.units, run.unit, run.units == 1 ? "" : "s",
                  options.jobs, std::max(1.0, jobs.task.seconds), formatBytes(jobs.task.memory));
  if (context.dryRun()) return context.plan({"write " + text}, 0);
  context.output(options.jobs);
  context.timed("write", [&] { writeJobs(kJobs, options.jobs, jobs); });
  context.print(text + "\n");
}

bool inShares(const ShareOptions& options) {
  return !options.share.empty() || !options.jobs.empty();
}

std::string cutToShare(const std::string& share, Frames& frames) {
  if (share.empty()) return "";
  const Share cut = parseShare(kShare, share);
  std::vector<std::uint64_t> weights;
  for (const std::size_t index : frames.wanted)
    weights.push_back(frames.weights.empty() ? 1 : frames.weights[index]);
  const auto [first, last] = cut.range(weights);
  frames.wanted = {frames.wanted.begin() + static_cast<std::ptrdiff_t>(first),
                   frames.wanted.begin() + static_cast<std::ptrdiff_t>(last)};
  frames.share = true;
  return fmt::format("{}/{}", cut.number, cut.of);
}

FrameShare::FrameShare(const std::string& share, const std::string& folder,
                       const std::string& inputs, const FramePattern* outputs, Frames& frames,
                       Context& context)
    : context_(context),
      frames_(frames),
      run_(runOf(inputs, frames, context.report())),
      inputs_(frames.all.size()) {
  if (context.page())
    throw UsageError("--html: a share has no page of its own; give --html to innermap join");
  if (outputs) outputs_ = *outputs;
  const std::string numbers = cutToShare(share, frames);
  const std::vector<std::size_t> mine = frames.wanted;
  if (!context.dryRun()) folder_.emplace(folder, run_);
  frames.wanted.clear();
  for (const std::size_t index : mine) {
    try {
      if (frames.source) inputs_[index] = frames.source->fingerprint(index);
    } catch (const FileError&) {  // a frame that cannot be read is told of in its turn
    }
    if (!isMade(frames.all[index].number, inputs_[index])) frames.wanted.push_back(index);
  }
  finished_ = mine.size() - frames.wanted.size();
  context.print(fmt::format("share {}: {} of {} {}s, {} of them finished already\n", numbers,
                            mine.size(), run_.frames.size(), frames.unit, finished_));
}

bool FrameShare::isMade(std::int64_t frame, const std::string& input) const {
  const auto part = folder_ ? folder_->find(frame, input) : std::nullopt;
  return part && (!outputs_ || hasOutput(*part, outputs_->path(frame)));
}

void FrameShare::begin(const PartValues& values) {
  const Report& report = context_.report();
  for (const Figure& figure : report.figures)
    if (figure.known) run_.figures.emplace_back(figure.key, figure.value);
  run_.values = values;
  run_.notes = report.notes;
  run_.warnings = report.warnings;
  folder_->writeRun(run_);
  warnings_ = report.warnings.size();
  seconds_ = report.seconds;
  setup_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

const std::string& FrameShare::inputOf(const FrameFile& file) const {
  const auto at = std::find_if(frames_.all.begin(), frames_.all.end(),
                               [&](const FrameFile& other) { return other.number == file.number; });
  return inputs_[static_cast<std::size_t>(at - frames_.all.begin())];
}

void FrameShare::ended(const FrameResult& result, PartValues values) {
  const Report& report = context_.report();
  Part part;
  part.frame = result.file.number;
  part.input = inputOf(result.file);
  part.broken = result.error;
  if (result.error.empty()) part.values = std::move(values);
  if (outputs_ && result.error.empty())
    part.values.emplace_back(kOutput, fingerprintOf(outputs_->path(part.frame)));
  part.warnings.assign(report.warnings.begin() + static_cast<std::ptrdiff_t>(warnings_),
                       report.warnings.end());
  part.host = hostName();
  part.code = partCode();
  part.seconds = result.seconds;
  part.setup = setup_;
  part.memory = peakMemory();
  part.restarts = taskRestarts();
  for (const auto& stage : report.seconds) {
    const auto before = std::find_if(seconds_.begin(), seconds_.end(),
                                     [&](const auto& s) { return s.first == stage.first; });
    part.stageSeconds.emplace_back(stage.first,
                                   stage.second - (before == seconds_.end() ? 0 : before->second));
  }
  warnings_ = report.warnings.size();
  seconds_ = report.seconds;
  writeFrame(
      result.file.number, [&] { folder_->write(part); }, frames_.unit);
}

void FrameShare::conclude(const std::vector<FrameResult>& results) {
  if (results.size() < frames_.wanted.size() && context_.failure().empty())
    context_.failAfterwards(
        fmt::format("{} {}s of the share are left; start the same command again",
                    frames_.wanted.size() - results.size(), frames_.unit));
}

bool hasOutput(const Part& part, const std::string& path) {
  return isWhole(path, textAt(part.values, kOutput));
}

void requireOutput(const Part& part, const std::string& path) {
  if (fingerprintOf(path) != textAt(part.values, kOutput))
    throw DataError(path +
                    ": has changed since it was written; remove it, and make its share again");
}

std::string hostName() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

}  // namespace innermap::tool
