#include "polycube_report.h"

#include <fmt/format.h>

#include "innermap/io/picture/mesh_picture.h"
#include "innermap/levelset/isosurface.h"
#include "inputs.h"
#include "map_report.h"

namespace innermap::tool {
namespace {

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

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

void addFillOptions(Command& c, std::string& mesh, int& blocks, bool& closeHoles, int& resolution) {
  c.positional("MESH", &mesh, "mesh file: .obj, .ply, .off or .stl");
  c.option("--blocks", "N", &blocks, "blocks along the longest side of the mesh's box; 0: chosen")
      .range(0, kMostAcross)
      .defaults("as many as give about 900 in all");
  c.flag("--close", &closeHoles, "close the holes of an open mesh by caps");
  c.option("--surface-resolution", "N", &resolution,
           "take the surface around the solid at so many voxels across instead of the mesh itself: "
           "for scans, overlapping parts and edges of three triangles")
      .unit("voxels")
      .range(0, 2048)
      .defaults("the mesh itself");
}

Mesh surfaceToFill(const std::string& path, int resolution, Context& context) {
  Mesh mesh = readMeshFile(path, context);
  if (resolution == 0) return mesh;
  if (resolution < 8) throw SettingError("--surface-resolution", "must be at least 8");
  const Solid solid =
      context.timed("solid", [&] { return Solid(mesh, context.settings<SolidSettings>()); });
  auto settings = context.settings<IsosurfaceSettings>();
  settings.resolution = resolution;
  Isosurface surface = context.timed("surface", [&] { return isosurfaceOf(solid, settings); });
  if (surface.leftOut > 0)
    context.note(
        fmt::format("{} shells of the surface are too small and left out", surface.leftOut));
  surface.mesh.name = path;
  return std::move(surface.mesh);
}

void requireMeshFile(const std::string& option, const std::string& path) {
  if (!endsWith(path, ".obj") && !endsWith(path, ".ply"))
    throw UsageError(option + " " + path + ": must end in .obj or .ply");
}

void reportPolycube(const Polycube& cube, Context& context) {
  Report& report = context.report();
  report.set("polycube.across", cube.across);
  report.set("polycube.blocks", cube.blocks.count());
  report.set("polycube.edge", cube.blocks.edge);
  report.set("polycube.handles", cube.handles);
  report.set("polycube.cavities", cube.cavities);
  report.set("polycube.missed", cube.missed);
  report.set("polycube.surplus", cube.surplus);
  report.setColumn("polycube.missed_parts.volume", cube.missedParts,
                   [](const MissedPart& p) { return p.volume; });
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (int a = 0; a < 3; ++a)
    report.setColumn(std::string("polycube.missed_parts.") + kAxes[a], cube.missedParts,
                     [a](const MissedPart& p) { return p.centre[a]; });
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

void drawPolycube(const std::string& path, const Mesh& mesh, const BlockSet& blocks,
                  Context& context) {
  writeMeshPicture(
      path,
      {flat(mesh, "mesh", {0.55, 0.6, 0.68}),
       flat(blockSurface(blocks, 1), fmt::format("{} blocks", blocks.count()), {0.85, 0.5, 0.22})},
      context.settings<MeshPictureSettings>());
}

}  // namespace innermap::tool
