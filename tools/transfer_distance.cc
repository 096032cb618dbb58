// `innermap transfer-distance`: the target's distance field through the map onto the source.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "commands.h"
#include "evaluation.h"
#include "innermap/core/file.h"
#include "innermap/evaluate/evaluate_map.h"
#include "innermap/io/picture/section_image.h"
#include "innermap/io/slice.h"
#include "innermap/io/vdb/vdb_file.h"
#include "innermap/levelset/level_set.h"
#include "innermap/transfer/distance_transfer.h"
#include "saved_map.h"

namespace innermap::tool {
namespace {

struct TransferDistanceOptions {
  std::string map, output;
  EvaluationOptions evaluation;
  std::string sectionAxis = "auto";
  std::optional<double> sectionAt;
  std::optional<NumberPair> range;
};

// A solid with its level set and what is known in it.
struct Field {
  openvdb::FloatGrid::Ptr surface, distance, own;  // own: of the source, its own distance
};

Field makeField(const Solid& solid, const TransferDistanceOptions& options, Context& context) {
  LevelSetSettings settings;
  settings.resolution = options.evaluation.resolution;
  settings.voxelSize = options.evaluation.voxelSize.value_or(0);
  settings.maxMemory = context.maxMemory();
  settings.progress = context.progress();
  Field field;
  context.timed("voxelize", [&] { field.surface = makeLevelSet(solid, settings); });
  DepthSettings depth;
  depth.maxMemory = context.maxMemory();
  depth.progress = context.progress();
  context.timed("distance", [&] { field.own = depthInside(solid, *field.surface, depth); });
  return field;
}

void pullDistance(const FieldFile& file, const BoundaryPair& pair, const Solid& target,
                  Field& source, Context& context) {
  EvaluateSettings settings;
  settings.jacobian = settings.harmonicEnergy = settings.deformationEnergy = false;
  settings.targetVolume = pair.targetVolume;
  settings.accuracy = sumAccuracy(file);
  settings.maxMemory = context.maxMemory();
  settings.progress = context.progress();
  MapGrids grids;
  context.timed("evaluate", [&] {
    grids = evaluateMap(HarmonicMap(file.field), pair.solid, *source.surface, settings);
  });
  if (grids.interiorVoxels == 0)
    throw DataError(pair.source.name +
                    ": is thinner than the voxels everywhere, none has its centre inside; use a "
                    "higher --resolution");
  context.timed("transfer",
                [&] { source.distance = depthThrough(*grids.map, target, {context.progress()}); });
}

// Of voxels whose centre is inside the solid.
struct InteriorValues {
  std::uint64_t voxels = 0, negative = 0;
  double largest = 0;
};

InteriorValues interiorValues(const openvdb::FloatGrid& distance,
                              const openvdb::FloatGrid& surface) {
  InteriorValues r;
  const auto inside = surface.getConstAccessor();
  for (auto v = distance.cbeginValueOn(); v; ++v) {
    if (!(inside.getValue(v.getCoord()) < 0)) continue;
    ++r.voxels;
    r.negative += *v < 0;
    r.largest = std::max(r.largest, static_cast<double>(*v));
  }
  return r;
}

void writeSection(const std::string& path, const std::string& title, const Solid& solid,
                  const openvdb::FloatGrid& distance, const openvdb::FloatGrid& surface,
                  const NumberPair& range, const TransferDistanceOptions& options,
                  Context& context) {
  const openvdb::GridBase::Ptr shown = distance.deepCopyGrid();
  shown->setName(title);
  const openvdb::GridBase::Ptr solidGrid = surface.deepCopyGrid();
  SectionSettings section;
  section.grid = title;
  section.axis = options.sectionAxis == "auto" ? thinnestAxis(solid.box().extent())
                                               : parseAxis("--section-axis", options.sectionAxis);
  section.at = options.sectionAt ? *options.sectionAt : fullLayer(*makeFog(surface), section.axis);
  section.range = range;
  section.maxMemory = context.maxMemory();
  section.progress = context.progress();
  writeSectionImage(path, {shown, solidGrid}, section);
}

void writeVdbs(const Field& source, const Field& target, const FieldFile& file,
               PendingFolder& folder, Context& context) {
  VdbWriteSettings settings;
  settings.progress = context.progress();
  source.own->setName("source_distance");
  const openvdb::GridPtrVec inSource{source.surface, source.distance, source.own};
  const openvdb::GridPtrVec inTarget{target.surface, target.own};
  describeMap(inSource, file);
  describeMap(inTarget, file);
  folder.write("source.vdb",
               [&](const std::string& path) { writeVdb(path, inSource, {}, settings); });
  folder.write("target.vdb",
               [&](const std::string& path) { writeVdb(path, inTarget, {}, settings); });
}

std::string fillReport(const Field& source, const Field& target, const NumberPair& range,
                       Context& context) {
  const InteriorValues through = interiorValues(*source.distance, *source.surface);
  const InteriorValues there = interiorValues(*target.own, *target.surface);
  const InteriorValues own = interiorValues(*source.own, *source.surface);
  const double outside =
      static_cast<double>(through.negative) / std::max<double>(1, double(through.voxels));
  Report& report = context.report();
  ReportGrid grid;
  grid.voxelSize = source.surface->voxelSize()[0];
  grid.activeVoxels = source.distance->activeVoxelCount();
  grid.interiorVoxels = through.voxels;
  report.grid = grid;
  report.set("grid.target_voxel_size", target.surface->voxelSize()[0]);
  report.set("grid.target_interior_voxels", static_cast<std::int64_t>(there.voxels));
  report.set("distance.largest_in_target", there.largest);
  report.set("distance.largest_through_map", through.largest);
  report.set("distance.largest_in_source", own.largest);
  report.set("distance.outside_fraction", outside);
  report.set("distance.range", std::vector<double>{range.first, range.second});
  return fmt::format(
      "target: {} voxels inside, up to {:.4g} from the surface\n"
      "source: {} voxels inside, up to {:.4g} through the map; {:.3g}% are mapped outside\n",
      there.voxels, there.largest, through.voxels, through.largest, 100 * outside);
}

void run(const TransferDistanceOptions& options, Context& context) {
  const FieldFile file = readMap(options.map, context);
  const BoundaryPair pair = boundaryOf(file, options.map, context);
  if (context.dryRun())
    return context.plan(
        {"transfer the target's distance field through " + options.map,
         "write source.vdb, target.vdb, source.png, target.png and report.json to " +
             options.output},
        evaluationMemory(pair.solid, options.evaluation));
  requireEvaluationMemory(pair.solid, options.evaluation, context);
  PendingFolder folder = context.outputFolder(options.output);
  context.notePictures();
  std::optional<Solid> targetOf;
  context.timed("solid", [&] { targetOf.emplace(targetSolid(pair, context)); });
  const Solid& solid = *targetOf;
  Field target = makeField(solid, options, context);
  Field source = makeField(pair.solid, options, context);
  pullDistance(file, pair, solid, source, context);
  const NumberPair range =
      options.range.value_or(NumberPair{0, interiorValues(*target.own, *target.surface).largest});
  const std::string text = fillReport(source, target, range, context);
  context.timed("write", [&] {
    folder.write("target.png", [&](const std::string& path) {
      writeSection(path, "distance in the target", solid, *target.own, *target.surface, range,
                   options, context);
    });
    folder.write("source.png", [&](const std::string& path) {
      writeSection(path, "the target's distance, through the map", pair.solid, *source.distance,
                   *source.surface, range, options, context);
    });
    writeVdbs(source, target, file, folder, context);
  });
  context.print(text);
  folder.write("report.json",
               [&](const std::string& path) { writeReport(path, context.finishedReport()); });
  folder.commit();
}

}  // namespace

Command makeTransferDistanceCommand() {
  auto o = std::make_shared<TransferDistanceOptions>();
  Command c("transfer-distance", "Show the target's distance field through a map on its source");
  c.description(
      "Each voxel p of the source gets how far f(p), where the map brings it, lies from the "
      "target's surface: exact everywhere inside, positive there. Writes source.vdb (`distance` "
      "through the map, the solid's own `source_distance`, `surface`), target.vdb (`distance`, "
      "`surface`), sections of both in the same colours, blue to red (source.png, target.png), "
      "and report.json into a folder.");
  c.positional("MAP", &o->map, "a map.ply written by fit or map");
  c.option("--output", "FOLDER", &o->output, "where the five files go; made when missing")
      .shortName("-o")
      .required();
  c.option("--resolution", "N", &o->evaluation.resolution,
           "voxels along the longest side of each solid")
      .range(4, 4096);
  c.option("--voxel-size", "L", &o->evaluation.voxelSize,
           "edge of a voxel, in place of --resolution")
      .unit("world units")
      .above(0)
      .defaults("by --resolution");
  c.option("--section-axis", "AXIS", &o->sectionAxis, "of the sections; auto: the thinnest")
      .choices({"auto", "x", "y", "z"});
  c.option("--section-at", "T", &o->sectionAt, "place of the sections along their axis")
      .unit("fraction of the box")
      .range(0, 1)
      .defaults("near the middle, where they cut most");
  c.option("--range", "LO,HI", &o->range, "distances that are blue and red")
      .defaults("0 to the largest in the target");
  c.example("innermap transfer-distance map.ply -o distance --resolution 256");
  c.run([o](Context& context) { run(*o, context); });
  return c;
}

}  // namespace innermap::tool
