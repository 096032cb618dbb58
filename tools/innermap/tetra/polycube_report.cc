#include "tetra/polycube_report.h"

#include <fmt/format.h>

#include "innermap/io/solid_pictures.h"
#include "report/figures.h"

namespace innermap::tool {
namespace {

// Each triangle with corners of its own, so that it is shaded flat.
PictureSurface flat(const Mesh& mesh, const std::string& label, const Vec3& colour) {
  PictureSurface surface;
  surface.label = label;
  for (const Triangle& t : mesh.triangles) {
    const int first = static_cast<int>(surface.vertices.size());
    for (const int v : t) surface.vertices.push_back(mesh.vertices[v]);
    surface.triangles.push_back({first, first + 1, first + 2});
  }
  surface.colours = [colour](const std::vector<VisiblePoint>& seen) {
    return std::vector<Vec3>(seen.size(), colour);
  };
  return surface;
}

}  // namespace

void addFillOptions(Command& c, std::string& mesh, PolycubeSettings& polycube,
                    SurfaceOptions& surface) {
  c.positional("MESH", &mesh, "mesh file: .obj, .ply, .off or .stl");
  c.settings(describe(polycube));
  addSurfaceOptions(c, surface);
}

void reportPolycube(const Polycube& cube, Context& context) {
  context.report().add("polycube", figures(cube));
  context.print(
      fmt::format("polycube: {} blocks, {} across, {} handles, {} cavities; of the solid's volume "
                  "{:.1f}% is in "
                  "no block and {:.1f}% is added\n",
                  cube.blocks.count(), cube.across, cube.handles, cube.cavities, 100 * cube.missed,
                  100 * cube.surplus));
  for (const MissedPart& p : cube.missedParts)
    context.print(
        fmt::format("  over half a block from all: {:.2g}% of the volume about ({:.4g}, "
                    "{:.4g}, {:.4g})\n",
                    100 * p.volume, p.centre.x, p.centre.y, p.centre.z));
}

void drawPolycube(const std::string& path, const Mesh& mesh, const BlockSet& blocks) {
  writeMeshPicture(
      path,
      {flat(mesh, "mesh", {0.55, 0.6, 0.68}),
       flat(blockSurface(blocks, 1), fmt::format("{} blocks", blocks.count()), {0.85, 0.5, 0.22})},
      MeshPictureSettings{});
}

}  // namespace innermap::tool
