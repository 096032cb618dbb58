// `innermap map`: the main job, from two meshes to grids, slices, a picture and a report.
#include <fmt/format.h>

#include <algorithm>

#include "boundary_pair.h"
#include "commands.h"
#include "evaluation.h"
#include "fitting.h"
#include "innermap/core/file.h"
#include "innermap/output/exr_slices.h"
#include "innermap/output/section_image.h"
#include "innermap/output/slice.h"
#include "section_place.h"

namespace innermap::tool {
namespace {

struct MapOptions {
  std::string source, target, output;
  FittingOptions fitting;
  EvaluationOptions evaluation;
  std::string sliceAxis = "z";
  std::uint64_t sliceCount = 16;
  std::string sectionGrid = "deformation_energy", sectionAxis = "auto";
  std::optional<double> sectionAt;
};

void writePictures(const openvdb::GridPtrVec& grids, const BoundaryPair& pair,
                   PendingFolder& folder, const MapOptions& options, Context& context) {
  ExrSliceSettings slices;
  slices.axis = parseAxis("--slice-axis", options.sliceAxis);
  slices.count = static_cast<int>(options.sliceCount);
  slices.maxMemory = context.maxMemory();
  slices.progress = context.progress();
  folder.write("slices.exr", [&](const std::string& path) { writeExrSlices(path, grids, slices); });
  SectionSettings section;
  section.grid = options.sectionGrid;
  section.axis = options.sectionAxis == "auto" ? thinnestAxis(pair.solid)
                                               : parseAxis("--section-axis", options.sectionAxis);
  section.at =
      options.sectionAt
          ? *options.sectionAt
          : fullLayer(*openvdb::gridConstPtrCast<openvdb::FloatGrid>(grids[1]), section.axis);
  section.maxMemory = context.maxMemory();
  section.progress = context.progress();
  folder.write("section.png",
               [&](const std::string& path) { writeSectionImage(path, grids, section); });
}

void run(const MapOptions& options, Context& context) {
  toleranceOf(options.fitting);  // refuses options that cannot be before anything is read
  const BoundaryPair pair = readBoundaryPair(options.source, options.target, context);
  const std::size_t vertices = pair.source.vertices.size();
  const std::uint64_t fitting = fittingMemory(options.fitting, vertices),
                      evaluation = evaluationMemory(pair.solid, options.evaluation);
  if (context.dryRun())
    return context.plan(
        {fittingPlan(options.fitting, vertices),
         "write map.ply, map.vdb, slices.exr, section.png and report.json to " + options.output},
        std::max(fitting, evaluation));
  requireFittingMemory(options.fitting, vertices, context);
  requireEvaluationMemory(pair.solid, options.evaluation, context);
  PendingFolder folder(options.output);
  const Fitted fitted = fitMap(pair, options.fitting, context);
  const openvdb::GridPtrVec grids = evaluateGrids(pair, fitted.file, options.evaluation, context);
  context.timed("write", [&] {
    folder.write("map.ply", [&](const std::string& path) { writeField(path, fitted.file); });
    folder.write("map.vdb", [&](const std::string& path) {
      writeGrids(path, grids, options.evaluation, context);
    });
    writePictures(grids, pair, folder, options, context);
  });
  context.print(fmt::format("boundary error: rms {:.2e}, 99% {:.2e}, max {:.2e} of the diagonal\n",
                            fitted.error.rms, fitted.error.p99, fitted.error.max) +
                evaluationText(context.report()));
  folder.write("report.json",
               [&](const std::string& path) { writeReport(path, context.finishedReport()); });
  folder.commit();
}

}  // namespace

Command makeMapCommand() {
  auto o = std::make_shared<MapOptions>();
  Command c("map", "Map the inside of a solid onto another: fit, evaluate, slice, report");
  c.description(
      "Writes map.ply (the map itself), map.vdb (its grids), slices.exr, section.png and "
      "report.json into a folder. SOURCE and TARGET have the same faces and vertex order.");
  c.positional("SOURCE", &o->source, "mesh of the solid: .obj, .ply, .off or .stl");
  c.positional("TARGET", &o->target, "the same mesh with its vertices moved");
  c.option("--output", "FOLDER", &o->output, "where the five files go; made when missing")
      .shortName("-o")
      .required();
  addFittingOptions(c, o->fitting);
  addEvaluationOptions(c, o->evaluation);
  c.option("--slice-axis", "AXIS", &o->sliceAxis, "of slices.exr").choices({"x", "y", "z"});
  c.option("--slice-count", "N", &o->sliceCount, "parts of slices.exr").range(1, 4096);
  c.option("--section-grid", "NAME", &o->sectionGrid, "grid shown in section.png")
      .choices({"surface", "density", "map", "jacobian", "harmonic_energy", "deformation_energy"});
  c.option("--section-axis", "AXIS", &o->sectionAxis, "of section.png; auto: the thinnest")
      .choices({"auto", "x", "y", "z"});
  c.option("--section-at", "T", &o->sectionAt, "place of the section along its axis")
      .unit("fraction of the box")
      .range(0, 1)
      .defaults("near the middle, where it cuts most");
  c.example("innermap map rest.obj pose.obj -o out");
  c.example("innermap map rest.obj pose.obj -o out --tolerance 3e-4 --resolution 256");
  c.run([o](Context& context) { run(*o, context); });
  return c;
}

}  // namespace innermap::tool
