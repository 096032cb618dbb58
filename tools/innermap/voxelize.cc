// `innermap voxelize`: a mesh as a level set, fog volume and attribute grids.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "block_share.h"
#include "commands.h"
#include "core/text_scanner.h"
#include "grid_options.h"
#include "innermap/core/memory.h"
#include "innermap/io/volume_texture.h"
#include "innermap/levelset/level_set.h"
#include "inputs.h"
#include "job_cost.h"
#include "lists.h"
#include "map_report.h"
#include "report/figures.h"

namespace innermap::tool {
namespace {

struct VoxelizeOptions {
  std::string mesh, output, labels;
  NamingScheme names = NamingScheme::innermap;
  LatticeChoice grid;
  LevelSetSettings levelSet;
  bool fog = false, attributes = false, each = false;
  ShareOptions farm;
};

void fillReport(const openvdb::FloatGrid& levelSet, const Solid& solid, const Mesh& mesh,
                Report& report) {
  reportSolid(mesh, solid, report);
  report.add("grid", gridFigures(levelSet.voxelSize().x(), levelSet.activeVoxelCount(),
                                 interiorVoxels(levelSet)));
}

// surface: the level set, with attributes behind it where these are made already.
openvdb::GridPtrVec makeGrids(const VoxelizeOptions& options, const Solid& solid, const Mesh& mesh,
                              openvdb::GridPtrVec surface, Context& context) {
  const auto levelSet = openvdb::gridPtrCast<openvdb::FloatGrid>(surface.front());
  openvdb::GridPtrVec grids = std::move(surface);
  if (options.fog)
    context.timed("fog", [&] { grids.insert(grids.begin() + 1, makeFog(*levelSet)); });
  context.timed("check", [&] {
    const LevelSetCheck check = checkLevelSet(*levelSet, solid);
    for (const std::string& warning : check.warnings) context.warning(warning);
    // Of several solids there is no one figure.
    if (!options.each) context.report().add("level_set", figures(check));
  });
  if (!options.each) fillReport(*levelSet, solid, mesh, context.report());
  return grids;
}

// The level set, and attributes.
openvdb::GridPtrVec makeSurface(const VoxelizeOptions& options, const Solid& solid,
                                const Mesh& mesh, const LevelSetSettings& settings,
                                Context& context) {
  if (context.joined())
    return joinVoxelized(solid, settings,
                         readShares(options.output, fingerprintOf(options.mesh), context));
  const openvdb::FloatGrid::Ptr levelSet =
      context.timed("level set", [&] { return makeLevelSet(solid, settings); });
  openvdb::GridPtrVec out{levelSet};
  if (options.attributes)
    context.timed("attributes", [&] {
      for (const auto& grid : makeAttributeGrids(*levelSet, solid, mesh)) out.push_back(grid);
    });
  return out;
}

BlockWork blockWork(const VoxelizeOptions& options, const Solid& solid, const Mesh& mesh,
                    const LevelSetSettings& settings) {
  constexpr std::uint64_t kSurface = 40'000'000, kAttribute = 60'000'000;  // bytes, at most
  const JobSize size = jobSize(solid, settings);
  BlockWork work;
  work.output = options.output;
  work.inputs = fingerprintOf(options.mesh);
  work.doing = "voxelize " + options.mesh;
  work.stage = "level set";
  work.blocks = [&] { return voxelBlocks(solid, settings); };
  work.make = [&](const VoxelBlock& block) {
    return voxelizeBlock(solid, settings, options.attributes ? &mesh : nullptr, block.origin);
  };
  work.memory = kSurface + (options.attributes ? 2 * kAttribute : 0);
  work.joinMemory = voxelizeMemory(solid, settings, mesh, options.fog, options.attributes);
  work.making = {stageOf("level set", size), stageOf("writing the VDB file", size)};
  work.joining = {stageOf("writing the VDB file", size, 2)};
  return work;
}

void write(const VoxelizeOptions& options, const openvdb::GridPtrVec& grids, Context& context) {
  openvdb::MetaMap metadata;
  metadata.insertMeta("innermap_source", openvdb::StringMetadata(options.mesh));
  writeGridFile(options.output, grids, options.names, context, metadata);
}

void requireNeed(const VoxelizeOptions& options, std::uint64_t need, double voxelSize,
                 Context& context) {
  context.requireMemory({"voxelizing " + options.mesh, need,
                         fmt::format("use a {{voxel_size}} above {:.3g}", 1.5 * voxelSize)});
}

void runMesh(const VoxelizeOptions& options, Context& context) {
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
  const JobSize size = jobSize(solid, settings);
  context.expect({stageOf("level set", size), stageOf("writing the VDB file", size)});
  if (madeInShares(options.farm, blockWork(options, solid, mesh, settings), context)) return;
  if (context.dryRun())
    return context.plan({fmt::format("voxelize {} with voxels of {:.6g} to {}", options.mesh,
                                     voxelSize, options.output)},
                        need);
  requireNeed(options, need, voxelSize, context);
  write(options,
        makeGrids(options, solid, mesh, makeSurface(options, solid, mesh, settings, context),
                  context),
        context);
}

// A scan of labels.

bool isScan(const std::string& path) {
  return volumeFormatOf(path).name == volumeFormatOf("a.nii").name;
}

std::vector<std::int64_t> labelsOf(const VoxelizeOptions& options) {
  constexpr std::int64_t kMost = 1'000'000'000;
  std::vector<std::int64_t> out;
  for (const std::string& text : commaList(options.labels)) {
    const auto number = parseInteger(text);
    if (!number || *number == 0 || std::abs(*number) > kMost)
      throw UsageError("--labels: '" + text + "' is no label; give whole numbers but 0, as in 1,3");
    out.push_back(*number);
  }
  return out;
}

double finestVoxelOf(const openvdb::GridBase& grid) {
  const openvdb::Vec3d size = grid.voxelSize();
  return std::min({size.x(), size.y(), size.z()});
}

void runScan(const VoxelizeOptions& options, Context& context) {
  if (options.attributes) throw UsageError("--attributes: is for meshes; leave it out");
  const std::vector<std::int64_t> labels = labelsOf(options);
  context.requireMemory({"reading " + options.mesh, volumeTextureReadNeed(options.mesh).memory,
                         "cut the scan or raise {max_memory}"});
  openvdb::GridPtrVec scan =
      context.timed("read", [&] { return readVolumeTexture(options.mesh).grids; });
  moveGrids(scan, inputToOutput(context.space()));
  const std::vector<LabelMesh> meshes =
      context.timed("labels", [&] { return labelMeshes(*scan.front(), labels, !options.each); });
  auto settings = options.grid.in(options.levelSet);
  if (!options.grid.voxelSize && !options.grid.resolution)
    settings.voxelSize = finestVoxelOf(*scan.front());
  const openvdb::Vec3d origin = scan.front()->indexToWorld(openvdb::Vec3d(0.0));
  settings.origin = Vec3{origin.x(), origin.y(), origin.z()};
  std::uint64_t need = 0;
  openvdb::GridPtrVec grids;
  for (const LabelMesh& label : meshes) {
    const Solid solid = context.timed("solid", [&] { return Solid(label.mesh); });
    const double voxelSize = voxelSizeFor(solid, settings);
    // A resolution is that of the first: all labels are on one lattice.
    settings.voxelSize = voxelSize;
    settings.resolution = 0;
    need += voxelizeMemory(solid, settings, label.mesh, options.fog, false);
    if (context.dryRun()) continue;
    requireNeed(options, need, voxelSize, context);
    for (const auto& grid :
         makeGrids(options, solid, label.mesh,
                   makeSurface(options, solid, label.mesh, settings, context), context)) {
      if (options.each) {
        grid->setName(fmt::format("{}_{}", grid->getName(), label.label));
        grid->insertMeta("innermap_label", openvdb::Int64Metadata(label.label));
      }
      grids.push_back(grid);
    }
    context.print(fmt::format("{}: {} voxels of the scan\n",
                              options.each ? label.mesh.name : "labels", label.voxels));
  }
  if (context.dryRun())
    return context.plan(
        {fmt::format("voxelize {} labels of {} with voxels of {:.6g} to {}", meshes.size(),
                     options.mesh, settings.voxelSize, options.output)},
        need);
  write(options, grids, context);
}

void run(const VoxelizeOptions& options, Context& context) {
  const bool scan = isScan(options.mesh);
  if (scan && inShares(options.farm))
    throw UsageError(
        "--share and --jobs: labels of a scan are voxelized in one run; leave them out");
  beginBlocks(options.farm, options.output, context);
  if (scan) return runScan(options, context);
  if (!options.labels.empty()) throw UsageError("--labels: is for scans (.nii, .nii.gz)");
  if (options.each) throw UsageError("--each-label: is for scans (.nii, .nii.gz)");
  runMesh(options, context);
}

}  // namespace

Command makeVoxelizeCommand() {
  auto o = std::make_shared<VoxelizeOptions>();
  Command c("voxelize", "Turn a mesh or labels of a scan into an OpenVDB level set");
  c.description(
      "The distance is exact in the band. The winding number tells inside from outside, so open, "
      "dirty and overlapping meshes work. voxelize checks the result against the mesh's volume and "
      "surface. Labels of a scan are solids whose surface runs halfway between voxels; the "
      "output's voxels are as fine as the scan's unless you choose another size.");
  c.positional("MESH", &o->mesh,
               "mesh file: .obj, .ply, .off, .stl or glTF; or a scan of labels, .nii or .nii.gz");
  c.option("--output", "FILE", &o->output, "the .vdb file to write")
      .shortName("-o")
      .required()
      .writes({".vdb"});
  c.settings(describe(o->grid, "the mesh's box"));
  c.settings(describe(o->levelSet));
  c.flag("--fog", &o->fog, "also write `density`: 1 inside, 0 outside, shares along the surface");
  c.flag("--attributes", &o->attributes,
         "also carry texture coordinates (`uv`) and vertex colours (`Cd`) onto the band");
  c.option("--labels", "LIST", &o->labels,
           "of a scan: labels of the solid, whole numbers with commas between")
      .defaults("all but 0");
  c.flag("--each-label", &o->each,
         "of a scan: make a solid of each label, `surface_3` for label 3, on one lattice; "
         "otherwise one of all together");
  c.setting(namesSetting(&o->names));
  addBlockOptions(c, o->farm);
  c.addSpace();
  c.example("innermap voxelize labels.nii.gz -o organs.vdb --labels 2,5 --each-label");
  c.example("innermap voxelize bunny.obj -o bunny.vdb --resolution 256 --fog");
  return c.running(o, run);
}

}  // namespace innermap::tool
