// `innermap transfer-distance`: the target's distance field through the map onto the source.
#include <fmt/format.h>

#include "commands.h"
#include "grid_options.h"
#include "innermap/transfer/distance_transfer.h"
#include "inputs.h"
#include "job_cost.h"
#include "report/figures.h"
#include "report/report_figures.h"
#include "report/verdict.h"
#include "section_options.h"

namespace innermap::tool {
namespace {

struct TransferDistanceOptions {
  std::string map, output;
  LatticeChoice grid;
  SectionOptions section;
  std::optional<NumberPair> range;
  VerdictSettings verdict;
};

void writeSection(const std::string& path, const std::string& title, const Solid& solid,
                  const openvdb::FloatGrid& distance, const openvdb::FloatGrid& surface,
                  const NumberPair& range, const TransferDistanceOptions& options) {
  const openvdb::GridBase::Ptr shown = distance.deepCopyGrid();
  shown->setName(title);
  const openvdb::GridBase::Ptr solidGrid = surface.deepCopyGrid();
  SectionSettings section = options.section.of(solid, *makeFog(surface));
  section.grid = title;
  section.range = range;
  writeSectionImage(path, {shown, solidGrid}, section);
}

void writeVdbs(const DistanceTransfer& made, const MappedSolid& mapped, PendingFolder& folder,
               Context& context) {
  const auto write = [&](const char* name, const openvdb::GridPtrVec& grids) {
    describeMap(grids, mapped);
    folder.write(name, [&](const std::string& path) {
      writeGridFile(path, grids, NamingScheme::innermap, context);
    });
  };
  write("source.vdb", {made.source.surface, made.through, made.source.depth});
  write("target.vdb", {made.target.surface, made.target.depth});
}

void fillReport(const DistanceTransfer& made, const NumberPair& range, Report& report) {
  report.add("grid", gridFigures(made.source.surface->voxelSize()[0],
                                 made.through->activeVoxelCount(), made.throughFigures.voxels));
  report.add("grid", targetGridFigures(made));
  report.add("distance", figures(made));
  report.add("distance", distanceRangeFigures(range));
}

std::string textOf(const DistanceTransfer& made) {
  return fmt::format(
      "target: {} voxels inside, up to {:.4g} from the surface\n"
      "source: {} voxels inside, up to {:.4g} through the map; {:.3g}% are mapped outside\n",
      made.target.figures.voxels, made.target.figures.largest, made.throughFigures.voxels,
      made.throughFigures.largest, 100 * made.outsideFraction);
}

// The target's distances, then the source's through the map and its own.
void expectPhases(const TransferDistanceOptions& options, const MappedSolid& mapped,
                  const Solid& target, Context& context) {
  const auto settings = options.grid.in<LevelSetSettings>();
  const JobSize there = jobSize(target, settings);
  const JobSize here = jobSize(mapped.solid(), settings, mapped.map.sources());
  JobPhase source = stageOf("level set", here);
  source.gate = true;
  context.expect({stageOf("level set", there), stageOf("distances", there), source,
                  stageOf("distances", here), stageOf("evaluating the map", here),
                  stageOf("distances", here), stageOf("drawing the section", here, 2),
                  stageOf("writing the VDB file", here, 2)});
}

void run(const TransferDistanceOptions& options, Context& context) {
  const auto folder = context.outputFolder(
      options.output, {"source.vdb", "target.vdb", "source.png", "target.png", "report.json"});
  const MappedSolid mapped = readMapFile(options.map, context);
  const Solid target = targetSolid(mapped, context);
  const auto need = [&](const LatticeChoice& grid) {
    return distanceTransferMemory(mapped.solid(), target, grid.in<DistanceTransferSettings>());
  };
  expectPhases(options, mapped, target, context);
  requireInterior(mapped.solid(), options.grid.in<LevelSetSettings>());
  if (!context.begins({"transfer the target's distance field through " + options.map,
                       "write source.vdb, target.vdb, source.png, target.png and report.json to " +
                           options.output},
                      gridNeed("transferring the distance", options.grid, need)))
    return;
  auto settings = options.grid.in<DistanceTransferSettings>();
  settings.accuracy = sumAccuracy(mapped);
  const DistanceTransfer made = transferDistance(mapped.map, mapped.solid(), target, settings);
  addSeconds(context.report().seconds, made.seconds);
  const NumberPair range = options.range.value_or(NumberPair{0, made.target.figures.largest});
  fillReport(made, range, context.report());
  context.timed("write", [&] {
    folder->write("target.png", [&](const std::string& path) {
      writeSection(path, "distance in the target", target, *made.target.depth, *made.target.surface,
                   range, options);
    });
    folder->write("source.png", [&](const std::string& path) {
      writeSection(path, "the target's distance, through the map", mapped.solid(), *made.through,
                   *made.source.surface, range, options);
    });
  });
  writeVdbs(made, mapped, *folder, context);
  context.judge(judgeMap(mapped, nullptr, options.verdict, MapOrigin::file));
  context.print(textOf(made));
  context.finish(*folder);
}

}  // namespace

Command makeTransferDistanceCommand() {
  auto o = std::make_shared<TransferDistanceOptions>();
  Command c("transfer-distance", "Carry the target's distance field through a map onto its source");
  c.description(
      "The map takes a voxel p of the source to f(p). p gets the distance of f(p) from the "
      "target's surface, which is exact and positive everywhere inside. Writes source.vdb "
      "(`distance` through the map, the solid's own `source_distance`, `surface`), target.vdb "
      "(`distance`, `surface`), sections of both in the same colours, blue to red (source.png, "
      "target.png), and report.json into a folder.");
  c.positional("MAP", &o->map, "a map.ply written by fit or map");
  c.outputFolder(&o->output, "folder for the five files; made if missing");
  c.settings(describe(o->grid, "each solid"));
  addSectionOptions(c, o->section);
  c.option("--range", "LO,HI", &o->range, "distances that are blue and red")
      .defaults("0 to the largest in the target");
  c.settings(describe(o->verdict));
  c.example("innermap transfer-distance map.ply -o distance --resolution 256");
  return c.running(o, run);
}

}  // namespace innermap::tool
