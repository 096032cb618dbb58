// Options that say how fine the grids that a command writes are, and what they are called.
#pragma once

#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "command.h"
#include "innermap/evaluate/map_grids.h"
#include "innermap/io/vdb/vdb_file.h"
#include "innermap/levelset/level_set.h"

namespace innermap::tool {

struct GridOptions {
  std::optional<int> resolution;  // without: the library's
  std::optional<double> voxelSize;
};

// of: what --resolution is along the longest side of.
void addGridOptions(Command& command, GridOptions& options, const std::string& of = "the solid",
                    const std::string& defaults = fmt::format("{}, more for a thin solid",
                                                              kUsualResolution));

// Settings of the library that have a resolution and a voxel size.
template <class Settings>
Settings gridSettings(const GridOptions& options, Settings settings = {}) {
  settings.resolution = options.resolution.value_or(settings.resolution);
  settings.voxelSize = options.voxelSize.value_or(0);
  return settings;
}

// Throws MemoryError, with the highest --resolution that would fit, when the need is over the
// limit. doing: "evaluating the map on a grid". need: bytes.
void requireGridMemory(const std::string& doing, const GridOptions& options, const Context& context,
                       const std::function<std::uint64_t(const GridOptions&)>& need);

void addNamesOption(Command& command, NamingScheme& names);

void writeGridFile(const std::string& path, const openvdb::GridPtrVec& grids,
                   const NamingScheme& names, Context& context,
                   const openvdb::MetaMap& metadata = {});

// What `evaluate`, `map` and `sequence` share.
struct EvaluationOptions {
  GridOptions grid;
  LameConstants lame;
  RepairFolds repair = RepairFolds::automatic;
  NamingScheme names = NamingScheme::innermap;
};

void addEvaluationOptions(Command& command, EvaluationOptions& options);

MapGridSettings mapGridSettings(const EvaluationOptions& options);

void requireEvaluationMemory(const Solid& solid, const GridOptions& options, const Context& context,
                             const MapGridKind& kind);

}  // namespace innermap::tool
