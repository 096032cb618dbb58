// `innermap map`: the main job, from two meshes to grids, slices, a picture and a report.
#include <fmt/format.h>

#include <algorithm>

#include "commands.h"
#include "correspondence.h"
#include "correspondence_picture.h"
#include "evaluation.h"
#include "fitting_options.h"
#include "innermap/core/file.h"
#include "innermap/io/exr/exr_slices.h"
#include "innermap/io/picture/section_image.h"
#include "innermap/io/slice.h"
#include "innermap/mesh/read.h"
#include "innermap/mesh/triangle_tree.h"
#include "innermap/mesh/write.h"
#include "map_report.h"

namespace innermap::tool {
namespace {

// Fractions of the target's diagonal.
constexpr double kOffTarget = 0.01;  // what half the vertices of --correspond may be
constexpr double kSubdivide = 0.005;

struct MapOptions {
  std::string source, target, output, correspondence;
  CorrespondOptions correspond;
  FittingOptions fitting;
  EvaluationOptions evaluation;
  std::string sliceAxis = "z";
  std::uint64_t sliceCount = 16;
  std::string sectionGrid = "deformation_energy", sectionAxis = "auto";
  std::optional<double> sectionAt;
};

void writePictures(const SolidGrids& solidGrids, const Solid& solid, PendingFolder& folder,
                   const MapOptions& options, Context& context) {
  const openvdb::GridPtrVec grids = solidGrids.all();
  ExrSliceSettings slices;
  slices.axis = parseAxis("--slice-axis", options.sliceAxis);
  slices.count = static_cast<int>(options.sliceCount);
  slices.maxMemory = context.maxMemory();
  slices.progress = context.progress();
  folder.write("slices.exr", [&](const std::string& path) { writeExrSlices(path, grids, slices); });
  SectionSettings section;
  section.grid = options.sectionGrid;
  section.axis = options.sectionAxis == "auto" ? thinnestAxis(solid.box().extent())
                                               : parseAxis("--section-axis", options.sectionAxis);
  section.at =
      options.sectionAt ? *options.sectionAt : fullLayer(*solidGrids.density, section.axis);
  section.maxMemory = context.maxMemory();
  section.progress = context.progress();
  folder.write("section.png",
               [&](const std::string& path) { writeSectionImage(path, grids, section); });
}

// The target that --correspond names, which must lie on TARGET if that is given too.
Mesh readCorrespondence(const MapOptions& options, const Mesh& source, Context& context) {
  ReadSettings settings;
  settings.progress = context.progress();
  Mesh moved;
  try {
    moved = readMeshLike(options.correspondence, source, settings);
  } catch (const DataError& error) {
    throw DataError(std::string(error.what()) +
                    "; where it was made with --subdivide, SOURCE is the .source.ply beside it");
  }
  if (options.target.empty()) return moved;
  const Mesh target = readMesh(options.target, settings);
  const TriangleTree tree(target.vertices, target.triangles);
  std::vector<double> distances;
  for (const Vec3& p : moved.vertices) distances.push_back(tree.closest(p).distance);
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  const double share = *middle / boundingBox(target).diagonal();
  if (!(share <= kOffTarget))
    throw DataError(fmt::format(
        "{}: does not lie on {}, half of its vertices are {:.2g} of the diagonal away or more; "
        "give the two that belong together",
        options.correspondence, options.target, share));
  return moved;
}

// Both meshes as the files have them; `related` tells whether they have the same connectivity.
struct Meshes {
  Mesh source, target;
  bool related = true;
};

Meshes readMeshes(const MapOptions& options, Context& context) {
  if (options.target.empty() && options.correspondence.empty())
    throw UsageError("TARGET is missing; give it, or --correspond (see 'innermap map --help')");
  Meshes meshes;
  context.timed("read", [&] {
    ReadSettings settings;
    settings.progress = context.progress();
    meshes.source = readMesh(options.source, settings);
    if (!options.correspondence.empty()) {
      meshes.target = readCorrespondence(options, meshes.source, context);
      return;
    }
    try {
      meshes.target = readMeshLike(options.target, meshes.source, settings);
    } catch (const DataError&) {
      meshes.target = readMesh(options.target, settings);
      meshes.related = false;
    }
  });
  return meshes;
}

std::string correspondPlan(const MapOptions& options, const Meshes& meshes) {
  return fmt::format(
      "{} and {} differ in connectivity, so the one is laid onto the other first, in about {:.0f} "
      "s",
      options.source, options.target,
      correspondSeconds(meshes.source.vertices.size(), meshes.target.vertices.size(),
                        options.correspond));
}

void plan(const MapOptions& options, const Meshes& meshes, Context& context) {
  const SourceBoundary source = makeSourceBoundary(meshes.source, {context.progress()});
  tell(source.notes, source.warnings, source.seconds, context);
  reportSource(source, context.report());
  const std::size_t vertices = meshes.source.vertices.size();
  const FitMapSettings fitting = fitMapSettings(options.fitting, vertices, context);
  std::vector<std::string> lines;
  std::uint64_t need =
      std::max(fitMapMemory(fitting),
               mapGridMemory(source.solid, mapGridSettings(options.evaluation, context)));
  std::string files = "map.ply, map.vdb, slices.exr, section.png";
  if (!meshes.related) {
    lines.push_back(correspondPlan(options, meshes));
    need = std::max(need, correspondMemory(vertices, meshes.target.vertices.size()));
    files += ", correspondence.ply, correspondence.png";
  }
  lines.push_back(fittingPlan(fitting));
  lines.push_back(fmt::format("write {} and report.json to {}", files, options.output));
  context.plan(lines, need);
}

// Lays the source onto the target where they are not related, and puts that into the folder.
BoundaryPair makePair(const MapOptions& options, Meshes meshes, PendingFolder& folder,
                      Context& context) {
  const BoundarySettings progress{context.progress()};
  if (meshes.related)
    return makeBoundaryPair(std::move(meshes.source), std::move(meshes.target), progress);
  context.note(correspondPlan(options, meshes) + "; --correspond takes one made before");
  const std::string name = meshes.target.name;
  const MeshCorrespondence moved =
      correspondMeshes(std::move(meshes.source), std::move(meshes.target), options.correspond,
                       options.fitting.seed, context);
  const Mesh target = moved.target(name);
  folder.write("correspondence.ply",
               [&](const std::string& path) { writeCorrespondence(path, moved); });
  if (moved.changed)
    folder.write("correspondence.source.ply",
                 [&](const std::string& path) { writeMesh(path, moved.source); });
  folder.write("correspondence.png",
               [&](const std::string& path) { writeCorrespondencePicture(path, moved, context); });
  return makeBoundaryPair(moved.source, target, progress);
}

void run(const MapOptions& options, Context& context) {
  checkFittingOptions(options.fitting);
  Meshes meshes = readMeshes(options, context);
  if (context.dryRun()) return plan(options, meshes, context);
  PendingFolder folder = context.outputFolder(options.output);
  context.notePictures();
  BoundaryPair pair = makePair(options, std::move(meshes), folder, context);
  tell(pair.notes, pair.warnings, pair.seconds, context);
  reportBoundaries(pair, context.report());
  const FitMapSettings fitting =
      fitMapSettings(options.fitting, pair.source.mesh.vertices.size(), context);
  const MapGridSettings gridSettings = mapGridSettings(options.evaluation, context);
  requireFittingMemory(fitting);
  requireEvaluationMemory(pair.solid(), gridSettings);
  const MapFit fit = fitMap(std::move(pair), fitting);
  tell(fit.notes, fit.warnings, fit.seconds, context);
  reportFit(fit, fitting, options.fitting.bestEffort, context);
  const SolidGrids grids = evaluateOnGrid(fit, gridSettings);
  tell(grids.notes, grids.warnings, grids.seconds, context);
  reportGrids(grids, gridSettings.lame, context.report());
  context.timed("write", [&] {
    folder.write("map.ply", [&](const std::string& path) { writeMap(path, fit); });
    folder.write("map.vdb", [&](const std::string& path) {
      writeGrids(path, grids.all(), options.evaluation, context);
    });
    writePictures(grids, fit.solid(), folder, options, context);
  });
  context.print(errorText(fit.error) + gridsText(grids));
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
      "report.json into a folder. Where SOURCE and TARGET have the same faces and vertex order, "
      "each vertex goes to its like. Any other TARGET is a shape that SOURCE is laid onto first, "
      "as "
      "innermap correspond does; correspondence.ply and correspondence.png then show how.");
  c.positional("SOURCE", &o->source, "mesh of the solid: .obj, .ply, .off or .stl");
  c.positional("TARGET", &o->target,
               "the same mesh with its vertices moved, or any other mesh; may be left out with "
               "--correspond")
      .optional();
  c.option("--output", "FOLDER", &o->output, "where the files go; made when missing")
      .shortName("-o")
      .required();
  c.option("--correspond", "FILE", &o->correspondence,
           "SOURCE's vertices on TARGET, as innermap correspond or an earlier map wrote them");
  o->correspond.subdivide = kSubdivide;
  addCorrespondOptions(c, o->correspond);
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
  c.example("innermap map cow.obj man.obj -o out");
  c.example("innermap map rest.obj pose.obj -o out --tolerance 3e-4 --resolution 256");
  c.run([o](Context& context) { run(*o, context); });
  return c;
}

}  // namespace innermap::tool
