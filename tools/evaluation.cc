#include "evaluation.h"

#include <fmt/format.h>

#include "innermap/core/memory.h"
#include "innermap/io/vdb/vdb_file.h"
#include "largest.h"

namespace innermap::tool {

void addEvaluationOptions(Command& command, EvaluationOptions& o) {
  command.option("--resolution", "N", &o.resolution, "voxels along the longest side of the solid")
      .range(4, 4096);
  command.option("--voxel-size", "L", &o.voxelSize, "edge of a voxel, in place of --resolution")
      .unit("world units")
      .above(0)
      .defaults("by --resolution");
  command.option("--lame-lambda", "X", &o.lame.lambda, "first elastic constant").range(0, 1e12);
  command.option("--lame-mu", "X", &o.lame.mu, "second elastic constant (shear)").range(0, 1e12);
  command.option("--names", "SCHEME", &o.names, "what the grids are called in the file")
      .choices({"innermap", "blender", "houdini"});
}

MapGridSettings mapGridSettings(const EvaluationOptions& options, const Context& context) {
  MapGridSettings settings;
  settings.resolution = options.resolution;
  settings.voxelSize = options.voxelSize.value_or(0);
  settings.lame = options.lame;
  settings.maxMemory = context.maxMemory();
  settings.progress = context.progress();
  return settings;
}

void requireEvaluationMemory(const Solid& solid, const MapGridSettings& settings) {
  const auto fits = [&](std::uint64_t resolution) {
    MapGridSettings s = settings;
    s.voxelSize = 0;
    s.resolution = static_cast<int>(resolution);
    return mapGridMemory(solid, s) <= settings.maxMemory;
  };
  const std::uint64_t most = largestThat(4, 4096, fits);
  requireMemory("evaluating the map on a grid", mapGridMemory(solid, settings), settings.maxMemory,
                most > 0 ? fmt::format("use --resolution {} or raise --max-memory", most)
                         : "raise --max-memory");
}

void writeGrids(const std::string& path, const openvdb::GridPtrVec& grids,
                const EvaluationOptions& options, Context& context) {
  VdbWriteSettings settings;
  settings.names = parseNamingScheme("--names", options.names);
  settings.progress = context.progress();
  writeVdb(path, grids, {}, settings);
}

}  // namespace innermap::tool
