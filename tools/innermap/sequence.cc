// `innermap sequence`: the energies of an animation's maps over its frames.
#include <fmt/format.h>

#include <algorithm>

#include "commands.h"
#include "core/file.h"
#include "frame_loop.h"
#include "grid_options.h"
#include "job_cost.h"
#include "lists.h"
#include "report/figures.h"
#include "report/page/page.h"
#include "report/report_figures.h"
#include "sequence_result.h"
#include "share.h"

namespace innermap::tool {
namespace {

constexpr const char* kEnergies = "energies";  // --grids alone

struct SequenceOptions {
  std::string rest, output;
  std::string grids, gridList;  // to write, and what their list was called once
  ShareOptions farm;
  FrameOptions frames;
  EvaluationOptions evaluation;
};

// The grids that are to be written; empty without --grids.
std::vector<std::string> gridsToWrite(const SequenceOptions& options) {
  if (options.grids.empty()) return {};
  std::string list = options.gridList.empty() ? options.grids : options.gridList;
  if (list == kEnergies) list = "harmonic_energy,deformation_energy";
  std::vector<std::string> names;
  for (const std::string& name : commaList(list)) {
    if (std::find(mapGridNames().begin(), mapGridNames().end(), name) == mapGridNames().end())
      throw UsageError(fmt::format("--grids: '{}' is not one of {}{}", name,
                                   fmt::join(mapGridNames(), ", "),
                                   didYouMean(name, mapGridNames())));
    if (std::find(names.begin(), names.end(), name) != names.end())
      throw UsageError("--grids: " + name + " is given twice");
    names.push_back(name);
  }
  if (names.empty()) throw UsageError("--grids: names no grid");
  return names;
}

// Those that are written, or else those that the page shows.
std::vector<std::string> gridsToMake(const SequenceOptions& options, Context& context) {
  const std::vector<std::string> written = gridsToWrite(options);
  if (!written.empty() || !context.page()) return written;
  return {"surface", "jacobian", "deformation_energy"};
}

FrameEvaluator makeEvaluator(const SequenceOptions& options, const FrameFitter& fitter,
                             Context& context) {
  FrameEvaluator made(fitter, gridsToMake(options, context), mapGridSettings(options.evaluation));
  addSeconds(context.report().seconds, made.seconds());
  for (const std::string& warning : made.warnings()) context.warning(warning);
  context.report().add("grid", voxelSizeFigures(made.voxelSize()));
  context.report().add("energy", figures(options.evaluation.lame));
  return made;
}

void run(const SequenceOptions& options, Context& context) {
  if (!options.frames.usd.empty() && options.grids.empty())
    throw UsageError("--usd: refers to grids; give --grids too");
  requireUsdOfAll(options.frames, inShares(options.farm));
  gridsToWrite(options);  // refuses names that cannot be before anything is read
  if (!options.gridList.empty()) context.note("--grid-list is now the list of --grids=LIST");
  Frames frames = listFrames(options.frames, options.rest, context);
  const FramePattern pattern("--output", options.output + "/energy.####.vdb");
  std::unique_ptr<PendingFolder> folder;
  std::optional<FrameShare> share;
  const bool asJobs = writesJobs(options.farm, context);
  if (!asJobs && options.farm.share.empty())
    folder = context.outputFolder(options.output, sequenceFiles());
  if (!options.farm.share.empty())
    share.emplace(options.farm.share, options.output, fingerprintOf(options.rest),
                  options.grids.empty() ? nullptr : &pattern, frames, context);
  if (frames.wanted.empty()) return;
  if (!options.grids.empty() && !asJobs) context.outputs(framePaths(pattern, frames));
  announceUsd(options.frames, context);
  const FrameFitterSettings settings = options.frames.fitting;
  SourceBoundary rest = readRest(options.rest, frames, context);
  requireInterior(rest.solid, options.evaluation.grid.in<LevelSetSettings>());
  const MemoryNeed need = sequenceNeed(settings, rest.solid, mapGridSettings(options.evaluation));
  const JobSize size = jobSize(rest.solid, mapGridSettings(options.evaluation), settings.sources);
  JobPhase each = stageOf("frames: grids", size);
  if (settings.prove != Prove::off)
    each += stageOf(settings.prove == Prove::full ? "frames: full proof" : "frames: proof", size);
  std::vector<JobPhase> phases = framePhases(settings.sources, frames.wanted.size(), each);
  phases.insert(phases.end() - 1, stageOf("level set", size));
  context.expect(phases);
  if (asJobs)
    return writeShareJobs(options.farm, {frames.wanted.size(), phases, need.bytes, options.output},
                          context);
  if (!context.begins({framesPlan(settings, frames),
                       "write " +
                           std::string(share ? "a part of each frame"
                                             : "energies.csv, energies.svg and report.json") +
                           (!options.grids.empty() ? " and the grids of each frame" : "") + " to " +
                           options.output},
                      need))
    return;
  const FrameFitter fitter = makeFrameFitter(std::move(rest), settings, context);
  const FrameEvaluator evaluator = makeEvaluator(options, fitter, context);
  FrameFits fits = makeFrameFits(fitter, frames, context);
  const SequenceJudge judge{fitter.rest().mesh.name, options.frames.tolerance,
                            options.frames.verdict};
  if (share) share->begin(partValues(judge));
  std::vector<SequenceRow> rows;
  PartValues made;
  context.print(sequenceHeader());
  const auto makeFrame = [&](std::size_t index) {
    const FrameFile& frame = frames.all[index];
    const std::shared_ptr<const FrameFit> fit = fits.at(index);
    const MapGrids grids = context.timed("evaluate", [&] { return evaluator.evaluate(*fit); });
    if (!options.grids.empty())
      writeFrame(frame.number, [&] {
        writeGridFile(pattern.path(frame.number), evaluator.grids({fit.get(), frame.number}, grids),
                      options.evaluation.names, context);
      });
    else if (context.page())
      addGrids(*context.page(), evaluator.grids({fit.get(), frame.number}, grids));
    SequenceRow row = sequenceRow(*fit, grids);
    row.file = frame;
    row.misses = !(fit->error.p99 <= options.frames.tolerance);
    rows.push_back(std::move(row));
    if (share) made = partValues(rows.back(), fit->jumps);
    context.print(sequenceLine(rows.back()));
  };
  const auto frameEnded = [&](const FrameResult& result) {
    if (share) share->ended(result, made);
  };
  const auto results =
      runFrames(frames, share || !options.grids.empty(), context, makeFrame, frameEnded);
  if (share) return share->conclude(results);
  writeUsd(options.frames, pattern, frames, context);
  concludeSequence(judge, rows, results, context, *folder);
  context.finish(*folder);
}

}  // namespace

Command makeSequenceCommand() {
  auto o = std::make_shared<SequenceOptions>();
  Command c("sequence", "Measure the energy of each frame of an animation against its rest pose");
  c.description(
      "Maps the inside of SOURCE onto that of each frame. The harmonic energy (3 for a rigid "
      "motion) and deformation energy (0 for one) go to energies.csv, energies.svg and report.json "
      "in a folder. sequence places charges once for all frames, and a frame's figures do not "
      "depend on the other frames. It reports and skips a frame that cannot be read or fitted; the "
      "exit code is then 1.");
  c.positional("SOURCE", &o->rest, "mesh of the rest pose: .obj, .ply, .off or .stl; or glTF");
  addFrameArgument(c, o->frames);
  c.outputFolder(&o->output);
  addFrameOptions(c, o->frames);
  FrameFitterSettings& fitting = o->frames.fitting;
  c.settings(describeProof(&fitting.prove, &fitting.proofCells));
  addEvaluationOptions(c, o->evaluation);
  c.option("--grids", "LIST", &o->grids,
           "also write grids over the rest pose, one energy.####.vdb for each frame: both "
           "energies, or those in LIST, with commas between: " +
               fmt::format("{}", fmt::join(mapGridNames(), ", ")))
      .implied(kEnergies);
  c.option("--grid-list", "LIST", &o->gridList, "formerly the LIST of --grids=LIST").advanced();
  addShareOptions(c, o->farm, "frames",
                  "Its figures go to parts/ in the output folder; innermap join puts all shares "
                  "together. A share skips frames that are finished");
  c.example("innermap sequence rest.obj 'frames/*.obj' -o energies");
  c.example("innermap sequence rest.obj 'walk.####.obj' -o energies --frames 1-48x2 --grids");
  return c.running(o, run);
}

}  // namespace innermap::tool
