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
// Without, to ask what would be needed.
LevelSetSettings levelSetSettings(const GridOptions& options);

// Throws MemoryError when need(options) bytes are over the limit, with the highest --resolution
// that would fit. doing: "evaluating the map on a grid".
void requireGridMemory(const std::string& doing, const GridOptions& options,
                       const std::function<std::uint64_t(const GridOptions&)>& need,
                       const Context& context);

void addNamesOption(Command& command, std::string& names);

// names: what --names gave.
void writeGridFile(const std::string& path, const openvdb::GridPtrVec& grids,
                   const std::string& names, Context& context,
                   const openvdb::MetaMap& metadata = {});

}  // namespace innermap::tool
