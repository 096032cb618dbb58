// `innermap map`: the main job, from two meshes to grids, slices, a picture and a report.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "block_share.h"
#include "command_words.h"
#include "commands.h"
#include "core/file.h"
#include "correspondence.h"
#include "fitting_options.h"
#include "grid_options.h"
#include "innermap/io/exr_slices.h"
#include "innermap/io/solid_pictures.h"
#include "innermap/mesh/mesh_file.h"
#include "inputs.h"
#include "job_cost.h"
#include "jobs/map_job.h"
#include "map_report.h"
#include "report/page/contents.h"
#include "report/verdict.h"
#include "section_options.h"

namespace innermap::tool {
namespace {

constexpr const char* kLaidFile = "correspondence.ply";
constexpr double kRepairShare = 0.3;       // of what --max-time leaves when the fit has ended
constexpr std::size_t kLikelyCharges = 2;  // a vertex

struct MapOptions {
  std::string source, target, output, correspondence;
  CorrespondOptions correspond;
  FittingOptions fitting;
  EvaluationOptions evaluation;
  VerdictSettings verdict;
  ExrSliceSettings slices;
  std::string sectionGrid = "deformation_energy";
  SectionOptions section;
  ShareOptions farm;
};

void writePictures(const SolidGrids& solidGrids, const MapFit& fit, PendingFolder& folder,
                   const MapOptions& options) {
  const openvdb::GridPtrVec grids = solidGrids.all();
  folder.write("slices.exr",
               [&](const std::string& path) { writeExrSlices(path, grids, options.slices); });
  SectionSettings section = options.section.of(fit.solid(), *solidGrids.density);
  section.grid = options.sectionGrid;
  folder.write("section.png",
               [&](const std::string& path) { writeSectionImage(path, grids, section); });
  if (fit.steps.empty()) return;
  folder.write("steps.png", [&](const std::string& path) { writeStepsPicture(path, fit); });
}

MapJob readJob(const MapOptions& options, Context& context) {
  if (options.target.empty() && options.correspondence.empty())
    throw UsageError("TARGET is missing; give it, or --correspond (see 'innermap map --help')");
  Mesh source = readMeshFile(options.source, context);
  if (!options.correspondence.empty()) {
    Mesh laid = context.timed("read", [&] {
      return inOutput(options.correspondence, readCorrespondence(options.correspondence, source),
                      context);
    });
    if (!options.target.empty()) requireOnTarget(laid, readMeshFile(options.target, context));
    return {std::move(source), std::move(laid), true, true};
  }
  requireMeshMemory(options.target, context);
  TargetMesh target = context.timed("read", [&] { return readTarget(options.target, source); });
  target.mesh = inOutput(options.target, std::move(target.mesh), context);
  if (!target.related && context.page()) addMesh(*context.page(), target.mesh);
  return {std::move(source), std::move(target.mesh), target.related};
}

std::string correspondPlan(const MapOptions& options) {
  return fmt::format("{} and {} differ in connectivity, so the one is laid onto the other first",
                     options.source, options.target);
}

// Before the solid is known: of the mesh as it was given.
JobSize gridSize(const MapOptions& options, const Mesh& source) {
  const LatticeChoice& grid = options.evaluation.grid;
  const Vec3 size = boundingBox(source).extent();
  const double longest = std::max({size.x, size.y, size.z});
  const double voxel =
      grid.voxelSize ? *grid.voxelSize : longest / grid.resolution.value_or(kUsualResolution);
  return jobSize(std::abs(signedVolume(source)), surfaceArea(source), voxel,
                 kLikelyCharges * source.vertices.size());
}

FitMapSettings fittingFor(const MapOptions& options, const MapJob& job) {
  return fitMapSettings(options.fitting, job.source.vertices.size(), job.laidOn());
}

// The job after the meshes are read; the seconds from the evaluation on.
double expectPhases(const MapOptions& options, const MapJob& job, Context& context) {
  const std::size_t vertices = job.source.vertices.size();
  const bool strangers = job.laidOn();
  std::vector<JobPhase> phases;
  if (!job.related) phases = correspondPhases(vertices + job.target.vertices.size());
  const FitMapSettings fitting = fittingFor(options, job);
  const double places = job.related ? bentPlaces(job.source, job.target.vertices, fitting.tolerance)
                                    : likelyPlaces(vertices, fitting.tolerance);
  for (const JobPhase& phase : fittingPhases(fitting, places, strangers)) phases.push_back(phase);
  const JobSize size = gridSize(options, job.source);
  JobPhase begin{"evaluating", 0};
  begin.gate = true;
  std::vector<JobPhase> last{begin};
  for (const JobPhase& phase : evaluationPhases(size)) last.push_back(phase);
  last.push_back(stageOf("writing slices", size));
  last.push_back(stageOf("drawing the section", size));
  phases.insert(phases.end(), last.begin(), last.end());
  context.expect(phases);
  return totalSeconds(last);
}

std::vector<std::string> planOf(const MapOptions& options, const MapJob& job,
                                const FitMapSettings& fitting) {
  std::vector<std::string> lines{fittingPlan(fitting)};
  std::string files = "map.ply, map.vdb, slices.exr, section.png";
  if (!job.related) {
    lines.insert(lines.begin(), correspondPlan(options));
    files += ", correspondence.ply, correspondence.png";
  }
  if (job.mayTakeSteps(fitting))
    lines.push_back(fmt::format("go in steps where one map folds and there are {} more memory",
                                formatBytes(kStepsMemory)));
  lines.push_back(fmt::format("write {} and report.json to {}", files, options.output));
  return lines;
}

// The fit is one job, whose map the shares of the voxels read.
void writeJobs(const MapOptions& options, Context& context) {
  const MapJob job = readJob(options, context);
  if (job.laidOn())
    throw UsageError(
        "--jobs: fits the same mesh with its vertices moved; make the map of other meshes in one "
        "run, and give its map.ply to innermap evaluate --jobs");
  const BoundaryPair pair = makeBoundaryPair(job.source, job.target);
  reportBoundaries(pair, context);
  const std::size_t vertices = job.source.vertices.size();
  const FitMapSettings fitting = fittingFor(options, job);
  BlockWork work = evaluationWork(pair.solid(), options.evaluation, kLikelyCharges * vertices,
                                  {1, needsLocalMap(job.target.vertices, fitting.tolerance)});
  work.output = (std::filesystem::path(options.output) / "map.vdb").string();
  ShareRun run = shareRun(work);
  const CommandLine& line = context.report().run->commandLine;
  if (const std::string option = keptByNone(line, {"fit", "evaluate"}); !option.empty())
    throw UsageError(option +
                     ": the jobs fit and evaluate alone, and make no pictures; leave it out");
  const std::string map = (std::filesystem::path(options.output) / "map.ply").string();
  run.first = handedOn(line, {"innermap", "fit", options.source, options.target, "-o", map}, false);
  run.command = handedOn(line, {"innermap", "evaluate", map, "-o", work.output}, false);
  run.beginning =
      fittingPhases(fitting, bentPlaces(job.source, job.target.vertices, fitting.tolerance), false);
  run.beginningBytes = fitMapMemory(fitting, vertices);
  if (!context.dryRun()) makeFolder(options.output);
  writeShareJobs(options.farm, run, context);
}

// Puts the source as it is laid onto the target into the folder.
BoundaryPair layPair(const MapOptions& options, MapJob job, PendingFolder& folder,
                     Context& context) {
  context.note(correspondPlan(options) + "; --correspond takes one made before");
  const std::string name = job.target.name;
  CorrespondOptions correspond = options.correspond;
  correspond.map = layingSettings(correspond.map, options.fitting.fit.seed);
  const MeshCorrespondence moved =
      correspondMeshes(std::move(job.source), std::move(job.target), correspond, context);
  const Mesh target = moved.target(name);
  folder.write(kLaidFile, [&](const std::string& path) { writeCorrespondence(path, moved); });
  if (moved.changed)
    folder.write("correspondence.source.ply",
                 [&](const std::string& path) { writeMesh(path, moved.source); });
  context.timed("picture", [&] {
    writeCorrespondencePictures(
        "correspondence.png", moved,
        [&](const std::string& file, const auto& write) { folder.write(file, write); });
  });
  BoundaryPair pair = makeBoundaryPair(moved.source, target);
  reportLaid(pair, options.output + "/" + kLaidFile, context);
  return pair;
}

// The same in a dry run as in a run: whether the job is to be done, or what is refused of it.
bool begins(const MapOptions& options, const MapJob& job, const Solid& solid, Context& context) {
  const FitMapSettings fitting = fittingFor(options, job);
  requireInterior(solid, options.evaluation.grid.in<LevelSetSettings>());
  return context.begins(planOf(options, job, fitting),
                        mapNeeds(job, solid, fitting, options.evaluation.grid));
}

// None in a dry run.
std::optional<BoundaryPair> makePair(const MapOptions& options, MapJob job, PendingFolder* folder,
                                     Context& context) {
  if (job.related) {
    BoundaryPair pair = makeBoundaryPair(job.source, job.target);
    reportBoundaries(pair, context);
    if (!begins(options, job, pair.solid(), context)) return {};
    return pair;
  }
  const SourceBoundary source = makeSourceBoundary(job.source);
  if (begins(options, job, source.solid, context))
    return layPair(options, std::move(job), *folder, context);
  reportSource(source, context);
  context.timed("check",
                [&] { requireLayable(job.source, job.target, options.correspond.map.layOut); });
  return {};
}

void run(const MapOptions& options, Context& context) {
  checkFittingOptions(options.fitting);
  if (writesJobs(options.farm, context)) return writeJobs(options, context);
  std::vector<std::string> files{"map.ply",     "map.vdb",   "slices.exr",
                                 "section.png", "steps.png", "report.json"};
  if (options.correspondence.empty())
    for (const char* name :
         {kLaidFile, "correspondence.source.ply", "correspondence.png", "correspondence.other.png"})
      files.emplace_back(name);
  const auto folder = context.outputFolder(options.output, files);
  MapJob job = readJob(options, context);
  const double later = expectPhases(options, job, context);
  const bool laid = job.laidOn();
  context.spend(kLayingTimeShare, later);
  std::optional<BoundaryPair> pair = makePair(options, std::move(job), folder.get(), context);
  if (!pair) return;
  const std::size_t vertices = pair->source.mesh.vertices.size();
  const FitMapSettings fitting = fitMapSettings(options.fitting, vertices, laid);
  // Laying may have made more vertices than mapNeeds() allows for.
  context.requireMemory(fitNeed(fitting, vertices));
  context.phase("fitting");
  context.spend(1, later);
  const MapFit fit = fitMap(std::move(*pair), fitting);
  reportFit(fit, fitting, options.fitting.bestEffort, context);
  context.phase("evaluating");
  context.spend(kRepairShare);
  const SolidGrids grids = evaluateOnGrid(fit, mapGridSettings(options.evaluation));
  reportGrids(grids, options.evaluation.lame, context);
  context.judge(judgeMap(fit, &grids, options.verdict,
                         laid ? MapOrigin::laidOn : MapOrigin::related, fitting));
  folder->write("map.vdb", [&](const std::string& path) {
    writeGridFile(path, grids.all(), options.evaluation.names, context);
  });
  context.timed("write", [&] {
    folder->write("map.ply", [&](const std::string& path) { writeMap(path, fit); });
    writePictures(grids, fit, *folder, options);
  });
  context.finish(*folder);
}

}  // namespace

Command makeMapCommand() {
  auto o = std::make_shared<MapOptions>();
  Command c("map", "Map the inside of a solid onto another: fit, evaluate, slice, report");
  c.description(
      "Writes map.ply (the map itself), map.vdb (its grids), slices.exr, section.png and "
      "report.json into a folder. If SOURCE and TARGET have the same faces and vertex order, each "
      "vertex goes to its counterpart. Otherwise map first lays SOURCE onto TARGET, as innermap "
      "correspond does, and shows how in correspondence.ply and correspondence.png. If the map "
      "goes in steps, steps.png shows the shapes on the way.");
  c.positional("SOURCE", &o->source, "mesh of the solid: .obj, .ply, .off or .stl");
  c.positional(
       "TARGET", &o->target,
       "the same mesh with its vertices moved, or any other mesh; not needed with --correspond")
      .optional();
  c.outputFolder(&o->output);
  c.limitTime(
      "stop trying, refining, stepping and repairing after this time; the rest still runs to its "
      "end");
  c.option("--correspond", "FILE", &o->correspondence,
           "SOURCE's vertices on TARGET, as innermap correspond or an earlier map wrote them")
      .reads();
  o->correspond.map.subdivide = kLaidOnSubdivide;
  addCorrespondOptions(c, o->correspond);
  addFittingOptions(c, o->fitting);
  addEvaluationOptions(c, o->evaluation);
  c.settings(describe(o->verdict));
  c.addSpace();
  c.group("slices and picture");
  c.choice("--slice-axis", "AXIS", &o->slices.axis, {{"x", 0}, {"y", 1}, {"z", 2}},
           "axis across the slices of slices.exr")
      .advanced();
  c.option("--slices", "N", &o->slices.count, "parts of slices.exr")
      .range(1, 4096)
      .advanced()
      .was("--slice-count");
  c.option("--section-grid", "NAME", &o->sectionGrid, "grid shown in section.png")
      .choices(mapGridNames());
  addSectionOptions(c, o->section);
  c.group("machines");
  addJobsOptions(c, o->farm);
  c.example("innermap map rest.obj pose.obj -o out");
  c.example("innermap map cow.obj man.obj -o out");
  c.example("innermap map rest.obj pose.obj -o out --tolerance 3e-4 --resolution 256");
  return c.running(o, run);
}

}  // namespace innermap::tool
