// `innermap sphere`: the spherical embedding of a closed surface by itself.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "commands.h"
#include "correspondence.h"
#include "innermap/core/memory.h"
#include "innermap/mesh/read.h"
#include "innermap/mesh/triangle_tree.h"
#include "innermap/mesh/write.h"

namespace innermap::tool {
namespace {

struct Options {
  std::string mesh, output;
  SurfaceOptions surface;
};

void requireNoHandles(const SurfaceInput& input) {
  for (const ClosedSurface& shell : input.shells().shells)
    if (shell.genus != 0)
      throw DataError(fmt::format(
          "{}: has {} handle{}, a sphere has none; innermap correspond maps solids with handles "
          "onto each other",
          input.mesh.name, shell.genus, shell.genus == 1 ? "" : "s"));
}

// Vertices in no shell lie where the nearest point of the shells lies.
Points placesOf(const SurfaceInput& input, std::size_t count) {
  const SurfaceShells& shells = input.shells();
  std::vector<Triangle> triangles;
  for (const std::vector<int>& list : shells.meshTriangle)
    for (const int t : list) triangles.push_back(shells.mesh.triangles[t]);
  const auto place = [&](int v) {
    const ShellVertex at = shells.shellVertex[v];
    return input.embedded.layout(static_cast<std::size_t>(at.shell)).place[at.vertex];
  };
  const TriangleTree tree(shells.mesh.vertices, triangles);
  Points places(count);
  for (std::size_t v = 0; v < count; ++v) {
    if (shells.shellVertex[v].shell >= 0) {
      places[v] = place(static_cast<int>(v));
      continue;
    }
    const SurfacePoint nearest = tree.closest(shells.mesh.vertices[v]).address;
    Vec3 sum;
    for (int k = 0; k < 3; ++k)
      sum += nearest.barycentric[k] * place(triangles[nearest.triangle][k]);
    places[v] = sum / norm(sum);
  }
  return places;
}

// The file's own triangles where they hold together as they are, else those of the shells.
Mesh onSphere(const SurfaceInput& input) {
  const SurfaceShells& shells = input.shells();
  const bool own = input.ownNumbers() && shells.splitVertices == 0;
  Mesh out;
  out.name = input.mesh.name;
  out.triangles = own ? input.mesh.triangles : shells.mesh.triangles;
  out.vertices = placesOf(input, own ? input.mesh.vertices.size() : shells.mesh.vertices.size());
  return out;
}

// Figures of all shells together.
LayoutQuality qualityOf(const SurfaceInput& input) {
  LayoutQuality total;
  total.areaRatioLog10 = std::numeric_limits<double>::infinity();
  double farthest = -1;
  for (std::size_t s = 0; s < input.shells().shells.size(); ++s) {
    const ClosedSurface& shell = input.shells().shells[s];
    const LayoutQuality q =
        layoutQuality(shell.triangles, shell.vertices, input.embedded.layout(s));
    total.flips += q.flips;
    total.areaRatioLog10 = std::min(total.areaRatioLog10, q.areaRatioLog10);
    if (std::abs(q.degree - 1) > farthest) {
      farthest = std::abs(q.degree - 1);
      total.degree = q.degree;
    }
  }
  return total;
}

void run(const Options& options, Context& context) {
  requirePly("--output", options.output);
  context.output(options.output);
  Mesh mesh;
  context.timed("read", [&] {
    ReadSettings settings;
    settings.progress = context.progress();
    mesh = readMesh(options.mesh, settings);
  });
  const std::size_t vertices = mesh.vertices.size();
  const std::uint64_t need = layOutMemory(vertices);
  if (context.dryRun())
    return context.plan(
        {fmt::format("lay the {} vertices of {} out on the unit sphere", vertices, options.mesh),
         "write them to " + options.output},
        need);
  requireMemory("the layout", need, context.maxMemory(), "use a coarser mesh");
  const SurfaceInput input = embedSurface(std::move(mesh), options.surface, context);
  context.report().source = reportOf(input);
  requireNoHandles(input);
  const LayoutQuality quality = qualityOf(input);
  Report& report = context.report();
  report.set("sphere.flips", static_cast<std::int64_t>(quality.flips));
  report.set("sphere.degree", quality.degree);
  report.set("sphere.area_ratio_log10", quality.areaRatioLog10);
  report.set("sphere.shells", static_cast<std::int64_t>(input.shells().shells.size()));
  context.timed("write", [&] { writeMesh(options.output, onSphere(input)); });
  context.print(fmt::format(
      "on the sphere: {} flip{}, degree {:.9f}, least area 10^{:.2f} of its share\n", quality.flips,
      quality.flips == 1 ? "" : "s", quality.degree, quality.areaRatioLog10));
}

}  // namespace

Command makeSphereCommand() {
  auto o = std::make_shared<Options>();
  Command c("sphere", "Lay a closed surface without handles out on the unit sphere");
  c.description(
      "Writes the mesh with its vertices on the unit sphere about the origin, no triangle flipped, "
      "areas near their share. Each shell (a cavity, say) covers the sphere by itself. With "
      "--surface-resolution, the isosurface of a mesh that is not clean is written instead.");
  c.positional("MESH", &o->mesh, "a closed mesh: .obj, .ply, .off or .stl");
  c.option("--output", "FILE", &o->output, "the .ply file to write").shortName("-o").required();
  addSurfaceOptions(c, o->surface);
  c.example("innermap sphere cow.obj -o cow_sphere.ply");
  c.run([o](Context& context) { run(*o, context); });
  return c;
}

}  // namespace innermap::tool
