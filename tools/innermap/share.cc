#include "share.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <limits>

#include "core/file.h"
#include "core/share.h"
#include "innermap/core/memory.h"
#include "innermap/core/version.h"
#include "run_record.h"

namespace innermap::tool {
namespace {

constexpr const char* kShare = "--share";
constexpr const char* kCpuTarget = "--cpu-target";

// Change no result, or where it goes.
bool decides(const std::string& setting) {
  for (const char* other : {"share", "output", "max_time", "force"})
    if (setting == other) return false;
  return true;
}

FigureValue partValue(const ReportValue& value) {
  return std::visit([](const auto& v) -> FigureValue { return v; }, value);
}

// As a run without --share would have been called.
std::vector<std::string> withoutShare(const std::vector<std::string>& commandLine) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < commandLine.size(); ++i) {
    if (commandLine[i] == kShare)
      ++i;
    else if (commandLine[i].rfind(std::string(kShare) + "=", 0) != 0)
      out.push_back(commandLine[i]);
  }
  return out;
}

PartRun runOf(const std::string& inputs, const Frames& frames, const Report& report) {
  PartRun run;
  run.command = report.command;
  run.version = versionText();
  run.inputs = inputs;
  for (const std::size_t index : frames.wanted) run.frames.push_back(frames.all[index]);
  run.commandLine = withoutShare(report.run->commandLine);
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

void addShareOptions(Command& command, ShareOptions& options) {
  command.group("machines");
  command
      .option(kShare, "K/N", &options.share,
              "make only the K-th of N shares of the frames, 3/40 say, or 'auto': the task of "
              "Slurm's job array, or OpenCue's, that this process is. The figures go to "
              "parts/ in the output's folder, and innermap join makes one run of them; what is "
              "finished is not "
              "made again")
      .advanced();
  command
      .option(kCpuTarget, "NAME", &options.cpuTarget,
              fmt::format("keep to the vector instructions of {}, so that newer processors compute "
                          "the same bits",
                          fmt::join(cpuNames(), " or ")))
      .defaults("this processor's best")
      .advanced();
}

void applyCpuTarget(const ShareOptions& options) {
  if (!options.cpuTarget.empty()) keepToCpu(kCpuTarget, options.cpuTarget);
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
  const Share cut = parseShare(kShare, share);
  const auto [first, last] = cut.range(frames.wanted.size());
  const auto at = [&](std::size_t i) {
    return frames.wanted.begin() + static_cast<std::ptrdiff_t>(i);
  };
  std::vector<std::size_t> mine(at(first), at(last));
  frames.share = true;
  if (!context.dryRun()) folder_.emplace(folder, run_);
  frames.wanted.clear();
  for (const std::size_t index : mine) {
    try {
      inputs_[index] = frames.source->fingerprint(index);
    } catch (const FileError&) {  // a frame that cannot be read is told of in its turn
    }
    if (!isMade(frames.all[index].number, inputs_[index])) frames.wanted.push_back(index);
  }
  finished_ = mine.size() - frames.wanted.size();
  context.print(fmt::format("share {}/{}: {} of {} frames, {} of them finished already\n",
                            cut.number, cut.of, mine.size(), run_.frames.size(), finished_));
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
  for (const auto& [stage, seconds] : report.seconds) {
    const auto before = std::find_if(seconds_.begin(), seconds_.end(),
                                     [&](const auto& s) { return s.first == stage; });
    part.stageSeconds.emplace_back(stage,
                                   seconds - (before == seconds_.end() ? 0 : before->second));
  }
  warnings_ = report.warnings.size();
  seconds_ = report.seconds;
  writeFrame(result.file, [&] { folder_->write(part); });
}

void FrameShare::conclude(const std::vector<FrameResult>& results) {
  if (results.size() < frames_.wanted.size() && context_.failure().empty())
    context_.failAfterwards(fmt::format("{} frames of the share are left; start it again",
                                        frames_.wanted.size() - results.size()));
}

bool hasOutput(const Part& part, const std::string& path) {
  return isWhole(path, textAt(part.values, kOutput));
}

std::string hostName() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

}  // namespace innermap::tool
