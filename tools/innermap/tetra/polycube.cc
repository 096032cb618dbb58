// `innermap polycube`: a solid as a few equal cubes.
#include <fmt/format.h>

#include <optional>

#include "commands.h"
#include "innermap/mesh/mesh_file.h"
#include "innermap/tetra/hexahedralize.h"
#include "jobs/tetra/cell_needs.h"
#include "report/report_figures.h"
#include "tetra/polycube_report.h"

namespace innermap::tool {
namespace {

struct PolycubeOptions {
  std::string mesh, output, picture;
  PolycubeSettings settings;
  SurfaceOptions surface;
  std::optional<int> pieces;
};

void run(const PolycubeOptions& options, Context& context) {
  context.output(options.output);
  if (!options.picture.empty()) context.output(options.picture);
  const Mesh mesh = readCleanSurface(options.mesh, options.surface, context);
  const PolycubeSettings settings = options.settings;
  if (!context.begins(
          {fmt::format("write a polycube of about {:.0f} blocks of {} to {}",
                       expectedBlocks(mesh, settings.blocks), options.mesh, options.output)},
          polycubeNeed(options.mesh, mesh, settings)))
    return;
  const Polycube cube = makePolycube(mesh, settings);
  context.tell(cube);
  reportPolycube(cube, context);
  const Mesh surface = blockSurface(cube.blocks, options.pieces.value_or(usualPieces(cube.blocks)));
  context.report().add("polycube", polycubeMeshFigures(surface.vertices.size()));
  context.timed("write", [&] { writeMesh(options.output, surface); });
  if (!options.picture.empty())
    context.timed("picture", [&] { drawPolycube(options.picture, mesh, cube.blocks); });
}

}  // namespace

Command makePolycubeCommand() {
  auto o = std::make_shared<PolycubeOptions>();
  Command c("polycube", "Approximate a solid by equal cubes");
  c.description(
      "Writes the surface of blocks that lie along the axes, as near to the solid as their number "
      "allows, with its handles and cavities. If polycube finds no such blocks, it fails and names "
      "a number that works. The surface's vertices are close enough together to map it (innermap "
      "map OUT MESH --aligned). MESH is one closed body with any number of handles and cavities.");
  addFillOptions(c, o->mesh, o->settings, o->surface);
  c.outputFile(&o->output, {".obj", ".ply"}, "the surface of the cubes, a .obj or .ply file");
  c.option("--pieces", "K", &o->pieces, "squares along a block's edge, of two triangles each")
      .range(1, kMostBlockPieces)
      .defaults("as many as give 3000 vertices");
  c.option("--picture", "FILE", &o->picture, "a .png of the mesh and the cubes").writes({".png"});
  c.example("innermap polycube spot.obj -o cubes.obj --blocks 12 --picture cubes.png");
  return c.running(o, run);
}

}  // namespace innermap::tool
