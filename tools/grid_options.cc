#include "grid_options.h"

#include <fmt/format.h>

#include "innermap/core/memory.h"
#include "innermap/io/vdb/vdb_file.h"
#include "largest.h"

namespace innermap::tool {
namespace {

constexpr int kLeast = 4, kMost = 4096;  // voxels along the longest side

}  // namespace

void addGridOptions(Command& c, GridOptions& o, const std::string& of) {
  c.option("--resolution", "N", &o.resolution, "voxels along the longest side of " + of)
      .range(kLeast, kMost);
  c.option("--voxel-size", "L", &o.voxelSize, "edge of a voxel, in place of --resolution")
      .unit("world units")
      .above(0)
      .defaults("by --resolution");
}

LevelSetSettings levelSetSettings(const GridOptions& options, const Context& context) {
  LevelSetSettings settings;
  settings.resolution = options.resolution;
  settings.voxelSize = options.voxelSize.value_or(0);
  settings.maxMemory = context.maxMemory();
  settings.progress = context.progress();
  return settings;
}

void requireGridMemory(const std::string& doing, std::uint64_t bytes, std::uint64_t limit,
                       const std::function<std::uint64_t(int resolution)>& needAt) {
  const std::uint64_t most = largestThat(kLeast, kMost, [&](std::uint64_t resolution) {
    return needAt(static_cast<int>(resolution)) <= limit;
  });
  requireMemory(doing, bytes, limit,
                most > 0 ? fmt::format("use --resolution {} or raise --max-memory", most)
                         : "raise --max-memory");
}

void addNamesOption(Command& command, std::string& names) {
  command.option("--names", "SCHEME", &names, "what the grids are called in the file")
      .choices({"innermap", "blender", "houdini"});
}

void writeGridFile(const std::string& path, const openvdb::GridPtrVec& grids,
                   const std::string& names, Context& context, const openvdb::MetaMap& metadata) {
  VdbWriteSettings settings;
  settings.names = parseNamingScheme("--names", names);
  settings.progress = context.progress();
  context.timed("write", [&] { writeVdb(path, grids, metadata, settings); });
}

}  // namespace innermap::tool
