// `innermap hexahedralize`: a mesh's inside as hexahedra.
#include "innermap/tetra/hexahedralize.h"

#include <fmt/format.h>

#include "commands.h"
#include "innermap/io/cell_file.h"
#include "innermap/mesh/mesh_file.h"
#include "job_cost.h"
#include "jobs/tetra/cell_needs.h"
#include "report/figures.h"
#include "tetra/cell_report.h"
#include "tetra/polycube_report.h"

namespace innermap::tool {
namespace {

struct Options {
  std::string mesh, output, picture, cubes, cubesPicture, inBlocks;
  HexahedralizeSettings settings;
  SurfaceOptions surface;
  SectionOptions cut;
};

void claimOutputs(const Options& options, Context& context) {
  for (const std::string* path : {&options.output, &options.inBlocks, &options.cubes,
                                  &options.picture, &options.cubesPicture})
    if (!path->empty()) context.output(*path);
}

void fillReport(const Hexahedralization& result, Context& context) {
  Report& report = context.report();
  reportPolycube(result.polycube, context);
  report.add("hexahedra", figures(result));
  report.add("boundary_map", boundaryMapFigures(result.boundaryMap));
  reportCells(result.mesh, result.quality, result.proof, context);
  context.print(
      fmt::format("inverted somewhere: {} as carried, {} now; {}\n", result.before.inverted,
                  result.after.inverted,
                  result.after.proven()
                      ? "the Jacobian's Bernstein coefficients prove all of them right side out"
                      : fmt::format("{} not decided", result.after.undecided)));
  reportBoundaryFit(result.boundary, context);
  report.add("features", featureFigures(result));
  if (result.featureLength > 0)
    context.print(
        fmt::format("sharp edges, not followed: {:.4g} long; the hexahedra's surface is "
                    "off them rms {:.2e}, max {:.2e}\n",
                    result.featureLength, result.fromFeatures.rms, result.fromFeatures.max));
}

void writeAll(const Options& options, const Mesh& mesh, const Hexahedralization& result,
              Context& context) {
  writeCellFile(options.output, result.mesh, context);
  context.timed("write", [&] {
    if (!options.inBlocks.empty()) writeCells(options.inBlocks, result.inBlocks);
    if (!options.cubes.empty())
      writeMesh(options.cubes, blockSurface(result.polycube.blocks, result.pieces));
  });
  drawCells(options.picture, result.mesh, result.quality, options.cut, options.mesh, context);
  if (!options.cubesPicture.empty())
    context.timed("picture",
                  [&] { drawPolycube(options.cubesPicture, mesh, result.polycube.blocks); });
}

void run(const Options& options, Context& context) {
  claimOutputs(options, context);
  const Mesh mesh = readCleanSurface(options.mesh, options.surface, context);
  const HexahedralizeSettings settings = options.settings;
  JobSize size;
  const double blocks = expectedBlocks(mesh, settings.polycube.blocks);
  size.items = blocks * std::pow(settings.pieces, 3) / 1000;
  std::vector<JobPhase> phases = correspondPhases(mesh.vertices.size());
  for (const char* stage : {"meeting the tolerance: cubes", "checking hexahedra",
                            "untangling hexahedra", "shaping hexahedra"})
    phases.push_back(stageOf(stage, size));
  context.expect(phases);
  if (!context.begins(
          {fmt::format("fill {} with hexahedra, {} along the edge of each of about {:.0f} blocks, "
                       "to {}",
                       options.mesh, settings.pieces, blocks, options.output)},
          hexahedraNeed(options.mesh, mesh, settings)))
    return;
  context.spend(Context::kMostOfTime);
  const Hexahedralization result = hexahedralize(mesh, settings);
  context.tell(result);
  fillReport(result, context);
  writeAll(options, mesh, result, context);
  if (!result.after.proven())
    context.failAfterwards(fmt::format(
        "{} hexahedra are inverted, or not proven right side out; the file still holds them",
        result.after.inverted + result.after.undecided));
}

}  // namespace

Command makeHexahedralizeCommand() {
  auto o = std::make_shared<Options>();
  Command c("hexahedralize", "Fill a mesh with hexahedra");
  c.description(
      "hexahedralize first makes a polycube of the solid (innermap polycube) and cuts its blocks "
      "into hexahedra, with one more layer around them. A harmonic map carries them into the "
      "solid. There it moves their vertices, those of the boundary along the surface, until no "
      "hexahedron is inverted. The Bernstein coefficients of each Jacobian prove it. Hexahedra "
      "come near sharp edges but do not follow them. MESH is one closed body with any number of "
      "handles and cavities. The exit code is 1 if some hexahedra stay inverted.");
  addFillOptions(c, o->mesh, o->settings.polycube, o->surface);
  c.outputFile(&o->output, {".vtu", ".msh", ".mesh"},
               "the .vtu, .msh (Gmsh 4.1) or .mesh (MEDIT) file to write, with each cell's "
               "scaled_jacobian (.vtu and .msh)");
  c.limitTime("stop fitting, untangling and shaping after this time");
  c.settings(without(describe(o->settings), {"blocks"}));
  c.option("--polycube", "FILE", &o->cubes, "also write the polycube's surface, .obj or .ply")
      .writes({".obj", ".ply"})
      .advanced();
  c.option("--in-blocks", "FILE", &o->inBlocks,
           "also write the same hexahedra in the polycube, .vtu, .msh or .mesh")
      .writes({".vtu", ".msh", ".mesh"})
      .advanced();
  addCellPicture(c, o->picture, o->cut,
                 "a .png of the hexahedra behind a cut, coloured by scaled Jacobian");
  c.option("--polycube-picture", "FILE", &o->cubesPicture, "a .png of the mesh and the polycube")
      .writes({".png"})
      .advanced();
  c.example("innermap hexahedralize spot.obj -o spot.vtu --picture spot.png");
  c.example("innermap hexahedralize part.obj -o part.msh --blocks 24 --polycube cubes.obj");
  return c.running(o, run);
}

}  // namespace innermap::tool
