// --resolution, --voxel-size and --names: how fine the grids that a command writes are, and what
// they are called.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "command.h"
#include "innermap/levelset/level_set.h"

namespace innermap::tool {

struct GridOptions {
  int resolution = LevelSetSettings().resolution;
  std::optional<double> voxelSize;
};

// of: what --resolution is along the longest side of.
void addGridOptions(Command& command, GridOptions& options, const std::string& of = "the solid");

// With the limit on memory and the progress of the context.
LevelSetSettings levelSetSettings(const GridOptions& options, const Context& context);

// Throws MemoryError when `bytes` are over the limit, with the highest --resolution that would fit.
// doing: "evaluating the map on a grid". needAt: the bytes at a resolution.
void requireGridMemory(const std::string& doing, std::uint64_t bytes, std::uint64_t limit,
                       const std::function<std::uint64_t(int resolution)>& needAt);

void addNamesOption(Command& command, std::string& names);

// names: what --names gave.
void writeGridFile(const std::string& path, const openvdb::GridPtrVec& grids,
                   const std::string& names, Context& context,
                   const openvdb::MetaMap& metadata = {});

}  // namespace innermap::tool
