// `innermap tetrahedralize`: a mesh's inside as tetrahedra.
#include "innermap/tetra/tetrahedralize.h"

#include <fmt/format.h>

#include <algorithm>

#include "commands.h"
#include "innermap/core/memory.h"
#include "inputs.h"
#include "job_cost.h"
#include "map_report.h"
#include "report/figures.h"
#include "tetra/cell_report.h"

namespace innermap::tool {
namespace {

struct TetrahedralizeOptions {
  std::string mesh, output, picture;
  TetrahedralizeSettings settings;
  bool anyTopology = false;
  SectionOptions cut;
};

// Measured: of a tetrahedron, the faces among which the boundary is found, its quality as fields
// and what is written; with a picture its faces and values there, and of the picture itself.
constexpr std::uint64_t kBytesACell = 110, kDrawnBytesACell = 132, kPicture = 200'000'000;

std::uint64_t memoryFor(const TetrahedralizeOptions& options, const Solid& solid,
                        const TetrahedralizeSettings& settings) {
  const StuffingNeed need = tetrahedralizeNeed(solid, settings);
  const std::uint64_t drawing =
      options.picture.empty() ? 0 : need.tetrahedra * kDrawnBytesACell + kPicture;
  return std::max({need.memory, drawing, need.tetrahedra * kBytesACell + need.vertices * 40});
}

void fillReport(const Tetrahedralization& result, const Mesh& mesh, const Solid& solid,
                Context& context) {
  Report& report = context.report();
  reportSolid(mesh, solid, report);
  report.add("topology", topologyFigures(result));
  report.add("lattice", latticeFigures(result));
  if (result.sharpCurves > 0) {
    report.add("features", featureFigures(result, solid.diagonal()));
    context.print(fmt::format(
        "sharp curves: {} of {} kept; off the mesh's edges rms {:.2e}, max {:.2e} (of the "
        "diagonal)\n",
        result.keptCurves, result.sharpCurves, result.sharpRms / solid.diagonal(),
        result.sharpMax / solid.diagonal()));
  }
  context.print(fmt::format("topology: {}{}\n", describe(result.topology),
                            result.solidTopology ? ", as the solid" : ""));
}

void run(const TetrahedralizeOptions& options, Context& context) {
  context.output(options.output);
  if (!options.picture.empty()) context.output(options.picture);
  const Mesh mesh = readMeshFile(options.mesh, context);
  const Solid solid = context.timed("solid", [&] { return Solid(mesh); });
  for (const std::string& note : solid.repaired().notes) context.note(options.mesh + ": " + note);
  TetrahedralizeSettings settings = options.settings;
  settings.keepTopology = !options.anyTopology;
  const std::uint64_t need = memoryFor(options, solid, settings);
  JobSize size;
  size.items = static_cast<double>(tetrahedralizeNeed(solid, settings).tetrahedra) / 1e6;
  JobPhase voxels = stageOf("level set: cells", size),
           thin = stageOf("looking for thin parts", size);
  voxels.steady = thin.steady = false;  // they come again where the solid is thin
  thin.perhaps = true;
  context.expect({voxels, thin, stageOf("filling with tetrahedra", size),
                  stageOf("fitting the boundary", size), stageOf("measuring cells", size),
                  stageOf("comparing the boundaries", size)});
  if (!context.begins(
          {fmt::format("fill {} with tetrahedra, to {}", options.mesh, options.output)},
          {"tetrahedra of " + options.mesh, need, "use a lower {resolution} or a longer {edge}"}))
    return;
  Tetrahedralization result =
      context.timed("tetrahedra", [&] { return tetrahedralization(solid, settings); });
  for (const std::string& note : result.notes) context.note(note);
  for (const std::string& warning : result.warnings) context.warning(warning);
  fillReport(result, mesh, solid, context);
  const CellQuality quality = context.timed("quality", [&] { return cellQuality(result.mesh); });
  const CellProof proof = context.timed("proof", [&] { return proveCells(result.mesh); });
  reportCells(result.mesh, quality, proof, context);
  reportBoundary(result.mesh, solid, proof, context);
  drawCells(options.picture, result.mesh, quality, options.cut, options.mesh, context);
  setQualityFields(result.mesh, quality);
  writeCellFile(options.output, result.mesh, context);
}

}  // namespace

Command makeTetrahedralizeCommand() {
  auto o = std::make_shared<TetrahedralizeOptions>();
  Command c("tetrahedralize", "Fill a mesh with tetrahedra");
  c.description(
      "Dihedral angles lie between 10 and 165 degrees. The boundary has the solid's components, "
      "cavities and handles; otherwise the command fails and names a resolution that works. Open, "
      "dirty and overlapping meshes work: if a solid's own surface does not tell its topology, "
      "tetrahedralize compares it with a lattice twice as fine. The file (.vtu and .msh) has each "
      "cell's least and greatest dihedral angle.");
  c.positional("MESH", &o->mesh, "mesh file: .obj, .ply, .off or .stl");
  c.outputFile(&o->output, {".vtu", ".msh", ".mesh"},
               "the .vtu, .msh (Gmsh 4.1) or .mesh (MEDIT) file to write");
  c.settings(without(describe(o->settings), {"keep_topology"}));
  c.flag("--any-topology", &o->anyTopology, "only warn if the solid's topology cannot be kept")
      .advanced();
  addCellPicture(c, o->picture, o->cut,
                 "a .png of the cells behind a cut, coloured by their least dihedral angle");
  c.example("innermap tetrahedralize part.obj -o part.msh --edge 0.02 --features 30");
  c.example("innermap tetrahedralize spot.obj -o spot.vtu --resolution 48 --picture spot.png");
  return c.running(o, run);
}

}  // namespace innermap::tool
