// `innermap sphere`: the spherical embedding of a closed surface by itself.
#include <fmt/format.h>

#include "commands.h"
#include "correspondence.h"
#include "innermap/core/memory.h"
#include "innermap/mesh/mesh_file.h"
#include "inputs.h"
#include "report/figures.h"
#include "report/report_figures.h"

namespace innermap::tool {
namespace {

struct SphereOptions {
  std::string mesh, output;
  SurfaceOptions surface;
};

void run(const SphereOptions& options, Context& context) {
  context.output(options.output);
  Mesh mesh = readMeshFile(options.mesh, context);
  const std::size_t vertices = mesh.vertices.size();
  if (context.dryRun()) requireSphere(mesh, options.surface.layOut);
  if (!context.begins(
          {fmt::format("lay the {} vertices of {} out on the unit sphere", vertices, options.mesh),
           "write them to " + options.output},
          {"the layout", layOutMemory(vertices), "use a coarser mesh"}))
    return;
  const LaidOutMesh laid = layOut(std::move(mesh), options.surface, context);
  reportLaidOut("source", laid, context.report());
  const MeshOnSphere sphere = onSphere(laid);
  const LayoutQuality& quality = sphere.quality;
  context.report().add("sphere", figures(quality));
  context.report().add("sphere", shellFigures(laid.shells().shells.size()));
  context.timed("write", [&] { writeMesh(options.output, sphere.mesh); });
  context.print(fmt::format(
      "on the sphere: {} flip{}, degree {:.9f}, least area 10^{:.2f} of its share\n", quality.flips,
      quality.flips == 1 ? "" : "s", quality.degree, quality.areaRatioLog10));
}

}  // namespace

Command makeSphereCommand() {
  auto o = std::make_shared<SphereOptions>();
  Command c("sphere", "Lay out a closed surface without handles on the unit sphere");
  c.description(
      "Writes the mesh with its vertices on the unit sphere about the origin. No triangle flips, "
      "and areas keep about their share. Each shell (a cavity, for example) covers the sphere by "
      "itself. If a mesh runs through itself, sphere lays out its outer surface.");
  c.positional("MESH", &o->mesh, "a closed mesh: .obj, .ply, .off or .stl");
  c.outputFile(&o->output, {".ply"}, "the .ply file to write");
  addSurfaceOptions(c, o->surface);
  c.example("innermap sphere cow.obj -o cow_sphere.ply");
  return c.running(o, run);
}

}  // namespace innermap::tool
