// `innermap remesh`: the cells of one solid made those of another by a map between them.
#include <fmt/format.h>

#include <optional>

#include "commands.h"
#include "innermap/core/memory.h"
#include "innermap/io/cell_file.h"
#include "innermap/tetra/cells.h"
#include "innermap/tetra/remesh_cells.h"
#include "inputs.h"
#include "job_cost.h"
#include "jobs/tetra/cell_needs.h"
#include "report/figures.h"
#include "tetra/cell_report.h"

namespace innermap::tool {
namespace {

struct RemeshOptions {
  std::string map, cells, surface, output, picture;
  RemeshSettings settings;
  SectionOptions cut;
};

void reportRemesh(const Remesh& result, double diagonal, Context& context) {
  context.report().add("remesh", figures(result, diagonal));
  context.print(fmt::format(
      "inverted: {} carried, {} repaired; vertices moved rms {:.2e}, max {:.2e}, {} swaps, {} "
      "collapses\nboundary's vertices off the surface: rms {:.2e}, max {:.2e} (of the diagonal)\n",
      result.invertedCarried, result.inverted, result.repair.moved / diagonal,
      result.repair.farthestMoved / diagonal, result.swaps, result.collapses, result.boundaryRms,
      result.boundaryMax));
}

void run(const RemeshOptions& options, Context& context) {
  if (!isCellFile(options.cells))
    throw UsageError(options.cells + ": must be a .vtu, .msh or .mesh file");
  context.output(options.output);
  if (!options.picture.empty()) context.output(options.picture);
  const MappedSolid mapped = readMapFile(options.map, context);
  const std::uint64_t reading = readCellsMemory(options.cells);
  context.requireMemory({"reading " + options.cells, reading, "use a coarser mesh"});
  CellFile file = context.timed("read", [&] { return readCells(options.cells); });
  for (const std::string& note : file.notes) context.note(note);
  JobSize size;
  size.items = static_cast<double>(file.mesh.tetrahedra.size() + file.mesh.hexahedra.size()) / 1e6;
  // Comes several times, with the like of it in between.
  JobPhase boundary = stageOf("repairing the boundary", size);
  boundary.steady = false;
  context.expect({stageOf("repairing", size), boundary, stageOf("improving shapes", size)});
  if (!context.begins({fmt::format("carry the {} cells of {} by {}",
                                   file.mesh.tetrahedra.size() + file.mesh.hexahedra.size(),
                                   options.cells, options.map),
                       "write " + options.output},
                      remeshNeed(options.cells, file.mesh, reading)))
    return;
  RemeshSettings settings = options.settings;
  std::optional<Mesh> surface;
  if (!options.surface.empty()) {
    surface = readMeshFile(options.surface, context);
    settings.surface = &*surface;
  }
  const Mesh own = settings.back ? sourceSurface(mapped) : targetSurface(mapped);
  const Mesh& onto = surface ? *surface : own;
  context.spend(Context::kMostOfTime);
  const Remesh result = remeshCells(file.mesh, mapped, settings);
  context.tell(result);
  reportRemesh(result, boundingBox(onto).diagonal(), context);
  reportCells(result.mesh, result.quality, result.proof, context);
  if (const std::string map = linearMapStatement(result.sourceProof, result.proof); !map.empty())
    context.print(map + "\n");
  reportBoundary(result.mesh, Solid(onto), result.proof, context);
  drawCells(options.picture, result.mesh, result.quality, options.cut, options.output, context);
  writeCellFile(options.output, result.mesh, context);
}

}  // namespace

Command makeRemeshCommand() {
  auto o = std::make_shared<RemeshOptions>();
  Command c("remesh", "Carry the cells that fill one solid onto another, with none inverted");
  c.description(
      "The map moves the vertices inside; those of the boundary go by their places on the surface. "
      "remesh repairs cells that turn inside out by moving vertices, those of the boundary along "
      "the surface. Then it improves tetrahedra with poor angles: it swaps edges and faces, "
      "collapses edges and moves vertices. The field `source` keeps where each vertex came from. "
      "Both places together are a piecewise linear map, which push and pull take with --through; "
      "it also turns vectors and normals among the fields. remesh reports what it proves of the "
      "written cells: whether one is inverted, and whether two overlap.");
  c.positional("MAP", &o->map, "a map.ply written by fit or map");
  c.positional("CELLS", &o->cells,
               "tetrahedra or hexahedra that fill the map's source: .vtu, .msh or .mesh");
  c.positional("SURFACE", &o->surface,
               "mesh whose surface the boundary goes onto, as you gave it to map; without it, the "
               "source's triangles where the map takes them")
      .optional();
  c.outputFile(&o->output, {".vtu", ".msh", ".mesh"},
               "the .vtu, .msh (Gmsh 4.1) or .mesh (MEDIT) file to write");
  c.limitTime("stop repairing and improving after this time");
  c.settings(describe(o->settings));
  addCellPicture(
      c, o->picture, o->cut,
      "a .png of the cells behind a cut, coloured by their least dihedral angle or scaled "
      "Jacobian");
  c.example("innermap remesh map.ply rest.vtu posed.obj -o posed.vtu");
  c.example("innermap remesh map.ply posed.vtu rest.obj -o back.vtu --back");
  return c.running(o, run);
}

}  // namespace innermap::tool
