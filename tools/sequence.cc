// `innermap sequence`: the energies of an animation's maps over its frames.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "commands.h"
#include "evaluation.h"
#include "frame_fits.h"
#include "frame_loop.h"
#include "innermap/core/file.h"
#include "innermap/io/picture/chart.h"
#include "innermap/io/vdb/vdb_file.h"
#include "innermap/levelset/level_set.h"
#include "sequence_table.h"

namespace innermap::tool {
namespace {

constexpr double kBand = 3;  // voxels: the skin of 2 and one more for interpolation
const std::vector<std::string> kGridNames = {"surface",  "density",         "map",
                                             "jacobian", "harmonic_energy", "deformation_energy"};

struct SequenceOptions {
  std::string rest, output, gridList = "harmonic_energy,deformation_energy";
  FrameOptions frames;
  EvaluationOptions evaluation;
  bool grids = false;
};

// The grids that are to be written; empty without --grids.
std::vector<std::string> gridsToWrite(const SequenceOptions& options) {
  if (!options.grids) return {};
  std::vector<std::string> names;
  for (std::size_t from = 0; from <= options.gridList.size();) {
    const std::size_t comma = std::min(options.gridList.find(',', from), options.gridList.size());
    const std::string name = options.gridList.substr(from, comma - from);
    if (std::find(kGridNames.begin(), kGridNames.end(), name) == kGridNames.end())
      throw UsageError(fmt::format("--grid-list: '{}' is not one of {}{}", name,
                                   fmt::join(kGridNames, ", "), didYouMean(name, kGridNames)));
    if (std::find(names.begin(), names.end(), name) != names.end())
      throw UsageError("--grid-list: " + name + " is given twice");
    names.push_back(name);
    from = comma + 1;
  }
  return names;
}

// What all frames have in common.
class Sequence {
 public:
  Sequence(const SequenceOptions& options, const FrameFitter& fitter, Context& context)
      : options_(options),
        fitter_(fitter),
        names_(gridsToWrite(options)),
        pattern_("--output", (std::filesystem::path(options.output) / "energy.####.vdb").string()),
        context_(context) {
    LevelSetSettings settings;
    settings.resolution = options.evaluation.resolution;
    settings.voxelSize = options.evaluation.voxelSize.value_or(0);
    settings.halfWidth = kBand;
    settings.maxMemory = context.maxMemory();
    settings.progress = context.progress();
    context.timed("voxelize", [&] {
      surface_ = makeLevelSet(fitter.solid(), settings);
      if (wants("density")) density_ = makeFog(*surface_);
      for (const std::string& warning : checkLevelSet(*surface_, fitter.solid()).warnings)
        context.warning(warning);
    });
  }

  // Solves, measures and, if asked for, writes one frame.
  SequenceRow run(const FrameFile& frame, const FrameFit& fit) const {
    MapGrids grids;
    context_.timed("evaluate", [&] {
      grids = evaluateMap(HarmonicMap(fit.field), fitter_.solid(), *surface_, settings(fit));
    });
    if (grids.interiorVoxels == 0)
      throw SettingError("--resolution", fitter_.rest().mesh.name +
                                             " is thinner than the voxels everywhere; use more");
    SequenceRow row;
    row.file = frame;
    row.error = fit.error;
    row.harmonic = grids.harmonicTotal;
    row.deformation = grids.deformationTotal;
    row.deformationMean = grids.volume > 0 ? grids.deformationTotal / grids.volume : 0;
    row.jacobianMin = grids.jacobianMin;
    row.jacobianMax = grids.jacobianMax;
    row.folded = grids.foldedFraction;
    row.volume = fit.boundary.volume;
    if (!names_.empty()) write(row, grids);
    return row;
  }

  void describe(Report& report) const {
    ReportGrid grid;
    grid.voxelSize = surface_->voxelSize()[0];
    grid.activeVoxels = surface_->activeVoxelCount();
    report.set("grid.voxel_size", grid.voxelSize);
    report.set("energy.lame_lambda", options_.evaluation.lame.lambda);
    report.set("energy.lame_mu", options_.evaluation.lame.mu);
  }

 private:
  bool wants(const char* name) const {
    return std::find(names_.begin(), names_.end(), name) != names_.end();
  }

  EvaluateSettings settings(const FrameFit& fit) const {
    EvaluateSettings s;
    s.map = wants("map");
    s.jacobian = wants("jacobian");
    s.harmonicEnergy = wants("harmonic_energy");
    s.deformationEnergy = wants("deformation_energy");
    s.lame = options_.evaluation.lame;
    s.targetVolume = fit.boundary.volume;
    s.accuracy = sumAccuracy(fit.error.rms);
    s.maxMemory = context_.maxMemory();
    s.progress = context_.progress();
    return s;
  }

  openvdb::GridPtrVec chosen(const MapGrids& grids) const {
    openvdb::GridPtrVec all = grids.all(), out;
    all.push_back(surface_);
    if (density_) all.push_back(density_);
    for (const std::string& name : names_)
      for (const openvdb::GridBase::Ptr& grid : all)
        if (grid->getName() == name) out.push_back(grid->copyGrid());  // the voxels are shared
    return out;
  }

  void write(const SequenceRow& row, const MapGrids& grids) const {
    const openvdb::GridPtrVec out = chosen(grids);
    openvdb::MetaMap file;
    const auto number = [&](const char* key, double value) {
      for (const openvdb::GridBase::Ptr& grid : out)
        grid->insertMeta(std::string("innermap_") + key, openvdb::DoubleMetadata(value));
    };
    for (const openvdb::GridBase::Ptr& grid : out)
      grid->insertMeta("innermap_frame", openvdb::Int64Metadata(row.file.number));
    number("harmonic_energy_total", row.harmonic);
    number("deformation_energy_total", row.deformation);
    number("jacobian_min", row.jacobianMin);
    number("jacobian_max", row.jacobianMax);
    number("folded_fraction", row.folded);
    number("boundary_error_rms", row.error.rms);
    number("boundary_error_p99", row.error.p99);
    number("boundary_error_max", row.error.max);
    VdbWriteSettings settings;
    settings.names = parseNamingScheme("--names", options_.evaluation.names);
    settings.progress = context_.progress();
    context_.timed("write", [&] {
      writeFrame(row.file, [&] { writeVdb(pattern_.path(row.file.number), out, file, settings); });
    });
  }

  const SequenceOptions& options_;
  const FrameFitter& fitter_;
  const std::vector<std::string> names_;
  const FramePattern pattern_;
  Context& context_;
  openvdb::FloatGrid::Ptr surface_, density_;
};

std::string planText(const FrameFitterSettings& settings, const Frames& frames) {
  return fmt::format("fit {} charges to {} boundary points for {} frames, {} to {}",
                     settings.sources, frameCollocation(settings), frames.wanted.size(),
                     frames.all[frames.wanted.front()].number,
                     frames.all[frames.wanted.back()].number);
}

void run(const SequenceOptions& options, Context& context) {
  gridsToWrite(options);  // refuses names that cannot be before anything is read
  const Frames frames = listFrames(options.frames, options.rest, context);
  const FrameFitterSettings settings = frameFitterSettings(options.frames, context);
  if (context.dryRun())
    return context.plan({planText(settings, frames),
                         "write energies.csv, energies.png and report.json" +
                             std::string(options.grids ? " and the grids of each frame" : "") +
                             " to " + options.output},
                        frameFitterMemory(settings));
  requireFrameMemory(settings, 0);
  PendingFolder folder = context.outputFolder(options.output);
  context.notePictures();
  const FrameFitter fitter = makeFrameFitter(options.rest, settings, context);
  requireFrameMemory(settings,
                     mapGridMemory(fitter.solid(), mapGridSettings(options.evaluation, context)));
  const Sequence sequence(options, fitter, context);
  FrameFits fits(fitter, frames, context);
  std::vector<SequenceRow> rows;
  context.print(sequenceHeader());
  std::vector<FrameResult> results =
      runFrames(frames, options.grids, context, [&](std::size_t index) {
        rows.push_back(sequence.run(frames.all[index], *fits.at(index)));
        context.print(sequenceLine(rows.back()));
      });
  const std::string seconds = secondsText(results, context);
  const std::vector<SequenceRow> table = withBroken(rows, results);
  sequence.describe(context.report());
  fillReport(table, context.report());
  context.timed("write", [&] {
    folder.write("energies.csv", [&](const std::string& path) { writeSequenceTable(path, table); });
    folder.write("energies.png", [&](const std::string& path) {
      writeChart(path, sequenceChart(table, fitter.rest().mesh.name));
    });
  });
  context.print(seconds);
  folder.write("report.json",
               [&](const std::string& path) { writeReport(path, context.finishedReport()); });
  folder.commit();
}

}  // namespace

Command makeSequenceCommand() {
  auto o = std::make_shared<SequenceOptions>();
  Command c("sequence", "Measure the energy of each frame of an animation against its rest pose");
  c.description(
      "Each frame's map is that of the inside of REST onto the frame's; its harmonic energy (3 for "
      "a rigid motion) and deformation energy (0 for one) go to energies.csv, energies.png and "
      "report.json in a folder. Charges are placed once for all frames; a frame's figures do not "
      "depend on the other frames. A frame that cannot be read or fitted is reported and left out; "
      "the exit code is then 1.");
  c.positional("REST", &o->rest, "mesh of the rest pose: .obj, .ply, .off or .stl");
  addFrameArgument(c, o->frames);
  c.option("--output", "FOLDER", &o->output, "where the files go; made when missing")
      .shortName("-o")
      .required();
  addFrameOptions(c, o->frames);
  addEvaluationOptions(c, o->evaluation);
  c.flag("--grids", &o->grids,
         "also write the energies' distribution over the rest pose, energy.####.vdb a frame");
  c.option("--grid-list", "LIST", &o->gridList,
           "grids that --grids writes, with commas between: " +
               fmt::format("{}", fmt::join(kGridNames, ", ")));
  c.example("innermap sequence rest.obj 'frames/*.obj' -o energies");
  c.example("innermap sequence rest.obj 'walk.####.obj' -o energies --frames 1-48x2 --grids");
  c.run([o](Context& context) { run(*o, context); });
  return c;
}

}  // namespace innermap::tool
