// `innermap join`: one run's files from the parts that its shares left.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "block_share.h"
#include "commands.h"
#include "report/page/page.h"
#include "report_page.h"
#include "sequence_result.h"
#include "share.h"

namespace innermap::tool {
namespace {

struct JoinOptions {
  std::string folder;
  bool partial = false;
};

ReportValue reportValue(const FigureValue& value) {
  struct Visitor {
    ReportValue operator()(std::uint64_t v) const { return static_cast<std::int64_t>(v); }
    ReportValue operator()(const bool& v) const { return v; }
    ReportValue operator()(const std::int64_t& v) const { return v; }
    ReportValue operator()(const double& v) const { return v; }
    ReportValue operator()(const std::string& v) const { return v; }
    ReportValue operator()(const std::vector<double>& v) const { return v; }
    ReportValue operator()(const std::vector<std::string>& v) const { return v; }
  };
  return std::visit(Visitor{}, value);
}

// The report becomes that of the run.
void takeRun(const PartRun& run, Context& context) {
  Report& report = context.report();
  report.command = run.command;
  report.run->commandLine = run.commandLine;
  report.run->date = run.date;
  report.run->settings.clear();
  for (const auto& [name, value] : run.reported)
    report.run->settings.emplace_back(name, reportValue(value));
}

// What all frames have in common.
void takeFindings(const PartRun& run, Context& context) {
  Report& report = context.report();
  for (const auto& [key, value] : run.figures) report.add("", {Figure(key, value, "")});
  for (const std::string& text : run.notes) context.note(text);
  for (const std::string& text : run.warnings) context.warning(text);
}

// "AVX2 on a, b; AVX3 on c", where there are several kinds.
void nameMix(const JoinedParts& joined, Context& context) {
  std::map<std::string, std::vector<std::string>> hosts;
  for (const Part& part : joined.parts) {
    std::vector<std::string>& names = hosts[part.code];
    if (std::find(names.begin(), names.end(), part.host) == names.end()) names.push_back(part.host);
  }
  if (hosts.size() < 2) return;
  std::vector<std::string> kinds;
  for (const auto& [code, names] : hosts)
    kinds.push_back(fmt::format("{} on {}", code, fmt::join(names, ", ")));
  context.warning(fmt::format(
      "workers used different vector instructions for the {}s ({}), so the last bits may differ",
      unitOf(joined.run), fmt::join(kinds, "; ")));
}

// What all commands have; results: of each frame or block.
std::vector<FrameResult> resultsOf(const JoinedParts& joined, Context& context) {
  std::vector<FrameResult> results;
  FarmFigures farm;
  std::vector<std::string> told;
  bool jumped = false;
  for (const Part& part : joined.parts) {
    const auto file = std::find_if(joined.run.frames.begin(), joined.run.frames.end(),
                                   [&](const FrameFile& f) { return f.number == part.frame; });
    results.push_back({*file, part.seconds, part.broken});
    farm.parts.push_back({part.host, part.code, part.seconds, part.setup, part.memory,
                          part.restarts, part.failures});
    addSeconds(context.report().seconds, part.stageSeconds);
    const std::string jumps = textAt(part.values, "jumps");
    if (!jumps.empty() && !jumped) noteJumps(part.frame, jumps, context);
    jumped = jumped || !jumps.empty();
    // Neighbours of two frames are told of by both.
    for (const std::string& text : part.warnings) {
      if (std::find(told.begin(), told.end(), text) != told.end()) continue;
      told.push_back(text);
      context.warning(text);
    }
  }
  nameMix(joined, context);
  context.report().add("farm", figures(farm));
  return results;
}

void requireAll(const JoinedParts& joined, const JoinOptions& options, Context& context) {
  if (joined.missing.empty()) return;
  const std::string text = missingText(options.folder, joined);
  if (!options.partial)
    throw DataError(text + "; make their shares" +
                    (unitOf(joined.run) == "frame" ? ", or join the others with --partial" : ""));
  if (joined.parts.empty()) throw DataError(text);
  context.warning(text);
}

void joinSequence(const JoinOptions& options, JoinedParts joined, Context& context) {
  const FramePattern pattern("FOLDER", options.folder + "/energy.####.vdb");
  const bool grids = !textAt(joined.run.settings, "grids").empty();
  if (grids) joined = partsWithFiles(std::move(joined), pattern, true);
  requireAll(joined, options, context);
  std::vector<std::string> beside{"parts"};
  for (const Part& part : joined.parts)
    beside.push_back(std::filesystem::path(pattern.path(part.frame)).filename().string());
  const auto folder = context.outputFolder(options.folder, sequenceFiles(), beside);
  if (context.dryRun())
    return context.plan({fmt::format("join {} frames", joined.parts.size()),
                         "write energies.csv, energies.svg and report.json to " + options.folder},
                        0);
  takeRun(joined.run, context);
  takeFindings(joined.run, context);
  const std::vector<FrameResult> results = resultsOf(joined, context);
  std::vector<SequenceRow> rows;
  context.print(sequenceHeader());
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (!results[i].error.empty()) continue;
    rows.push_back(sequenceRow(joined.parts[i].values));
    rows.back().file = results[i].file;
    context.print(sequenceLine(rows.back()));
    if (grids) context.outputInPlace(pattern.path(results[i].file.number));
  }
  concludeFrames(results, joined.missing.size(), context);
  concludeSequence(sequenceJudge(joined.run.values), rows, results, context, *folder);
  if (context.page())
    showOutputs(*context.page(), reportJson(context.finishedReport()), options.folder);
  context.finish(*folder);
}

// A volume: the command that was run in shares takes the blocks in place of making them, and goes
// on as it does with its own.
void joinVolume(const JoinOptions& options, JoinedParts joined, Context& context) {
  if (options.partial) throw UsageError("--partial: is for frames; a volume needs all blocks");
  const std::string output = outputOf(options.folder);
  joined = partsWithFiles(std::move(joined), blockPattern(options.folder), false);
  requireAll(joined, options, context);
  const Command command = findCommand(joined.run.command);
  CommonOptions common;
  const std::vector<std::string>& line = joined.run.commandLine;
  parseArguments(command, common,
                 {line.begin() + std::min<std::ptrdiff_t>(2, line.size()), line.end()});
  for (const Option& option : command.options()) {
    const auto text = std::get_if<std::string*>(&option.target);
    if (text && option.isInput && !(*text)->empty()) context.input(**text);
    if (text && option.name == "--output") **text = output;
  }
  if (!common.cpuTarget.empty()) keepToCpu("--cpu-target", common.cpuTarget);
  takeRun(joined.run, context);
  resultsOf(joined, context);
  context.joins(std::make_shared<const JoinedParts>(std::move(joined)), command.space(),
                command.maxTime());
  command.execute(context);
}

void run(const JoinOptions& options, Context& context) {
  JoinedParts joined = context.timed("read", [&] { return readParts(options.folder); });
  if (joined.run.command == "sequence") return joinSequence(options, std::move(joined), context);
  for (const char* volume : {"evaluate", "push", "pull", "voxelize"})
    if (joined.run.command == volume) return joinVolume(options, std::move(joined), context);
  throw DataError(options.folder + ": holds parts of '" + joined.run.command +
                  "', which has nothing to join");
}

}  // namespace

Command makeJoinCommand() {
  auto o = std::make_shared<JoinOptions>();
  Command c("join", "Join the shares of a run that was made on several machines");
  c.description(
      "Reads the parts that sequence --share left in FOLDER/parts, and writes the files of one "
      "run: energies.csv, energies.svg and report.json. The figures are the same however you cut "
      "the run. If frames are missing, join names them and writes nothing, unless you give "
      "--partial. It refuses parts of two runs or of another version, parts that are cut off, and "
      "frames that two workers made with different results. Workers may write more parts "
      "meanwhile. From the blocks that evaluate, push, pull or voxelize --share left in "
      "map.vdb.shares, join makes map.vdb. It reads the command's inputs again and does what takes "
      "the whole volume, such as repairing folds, making fog, and turning carried level sets into "
      "distances, so it needs the memory of the whole volume.");
  c.positional("FOLDER", &o->folder,
               "the output folder of a run with --share; for a volume, the folder .shares beside "
               "the output");
  c.flag("--partial", &o->partial, "join the frames that are there");
  c.example("innermap join energies");
  c.example("innermap join map.vdb.shares");
  return c.running(o, run);
}

}  // namespace innermap::tool
