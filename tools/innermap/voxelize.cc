// `innermap voxelize`: a mesh as a level set, fog volume and attribute grids.
#include <fmt/format.h>

#include "commands.h"
#include "grid_options.h"
#include "innermap/core/memory.h"
#include "innermap/levelset/level_set.h"
#include "inputs.h"
#include "map_report.h"
#include "report/figures.h"

namespace innermap::tool {
namespace {

struct VoxelizeOptions {
  std::string mesh, output;
  NamingScheme names = NamingScheme::innermap;
  LatticeChoice grid;
  LevelSetSettings levelSet;
  bool fog = false, attributes = false;
};

void fillReport(const openvdb::FloatGrid& levelSet, const Solid& solid, const Mesh& mesh,
                Report& report) {
  reportSolid(mesh, solid, report);
  report.add("grid", gridFigures(levelSet.voxelSize().x(), levelSet.activeVoxelCount(),
                                 interiorVoxels(levelSet)));
}

openvdb::GridPtrVec makeGrids(const VoxelizeOptions& options, const Solid& solid, const Mesh& mesh,
                              const LevelSetSettings& settings, Context& context) {
  const openvdb::FloatGrid::Ptr levelSet =
      context.timed("level set", [&] { return makeLevelSet(solid, settings); });
  openvdb::GridPtrVec grids = {levelSet};
  if (options.fog) context.timed("fog", [&] { grids.push_back(makeFog(*levelSet)); });
  if (options.attributes)
    context.timed("attributes", [&] {
      for (const auto& grid : makeAttributeGrids(*levelSet, solid, mesh)) grids.push_back(grid);
    });
  context.timed("check", [&] {
    const LevelSetCheck check = checkLevelSet(*levelSet, solid);
    for (const std::string& warning : check.warnings) context.warning(warning);
    context.report().add("level_set", figures(check));
  });
  fillReport(*levelSet, solid, mesh, context.report());
  return grids;
}

void run(const VoxelizeOptions& options, Context& context) {
  context.output(options.output);
  const Mesh mesh = readMeshFile(options.mesh, context);
  const Solid solid = context.timed("solid", [&] { return Solid(mesh); });
  for (const std::string& note : solid.repaired().notes) context.note(options.mesh + ": " + note);
  if (options.attributes && mesh.uvs.empty() && mesh.colours.empty())
    context.warning(options.mesh +
                    " has neither texture coordinates nor vertex colours to carry over");
  const auto settings = options.grid.in(options.levelSet);
  const double voxelSize = voxelSizeFor(solid, settings);
  if (const std::string note = voxelSizeNote(solid, settings); !note.empty()) context.note(note);
  const std::uint64_t need = voxelizeMemory(solid, settings, mesh, options.fog, options.attributes);
  if (context.dryRun())
    return context.plan({fmt::format("voxelize {} with voxels of {:.6g} to {}", options.mesh,
                                     voxelSize, options.output)},
                        need);
  context.requireMemory("voxelizing " + options.mesh, need,
                        fmt::format("use a --voxel-size above {:.3g}", 1.5 * voxelSize));
  const openvdb::GridPtrVec grids = makeGrids(options, solid, mesh, settings, context);
  openvdb::MetaMap metadata;
  metadata.insertMeta("innermap_source", openvdb::StringMetadata(options.mesh));
  writeGridFile(options.output, grids, options.names, context, metadata);
}

}  // namespace

Command makeVoxelizeCommand() {
  auto o = std::make_shared<VoxelizeOptions>();
  Command c("voxelize", "Turn a mesh into an OpenVDB level set");
  c.description(
      "The distance is exact in the band; inside and outside are told by the winding number, so "
      "open, dirty and overlapping meshes work. The result is checked against the mesh's volume "
      "and surface.");
  c.positional("MESH", &o->mesh, "mesh file: .obj, .ply, .off or .stl");
  c.option("--output", "FILE", &o->output, "the .vdb file to write")
      .shortName("-o")
      .required()
      .writes({".vdb"});
  c.settings(describe(o->grid, "the mesh's box"));
  c.settings(describe(o->levelSet));
  c.flag("--fog", &o->fog, "also write `density`: 1 inside, 0 outside, shares along the surface");
  c.flag("--attributes", &o->attributes,
         "also carry texture coordinates (`uv`) and vertex colours (`Cd`) onto the band");
  c.setting(namesSetting(&o->names));
  c.example("innermap voxelize bunny.obj -o bunny.vdb --resolution 256 --fog");
  c.run([o](Context& context) { run(*o, context); });
  return c;
}

}  // namespace innermap::tool
