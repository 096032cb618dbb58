// Options that say on which voxels a map is evaluated: what `evaluate`, `map`, `sequence` and
// `transfer-distance` share.
#pragma once

#include <optional>
#include <string>

#include "command.h"
#include "innermap/evaluate/map_grids.h"

namespace innermap::tool {

struct EvaluationOptions {
  int resolution = 128;
  std::optional<double> voxelSize;
  LameConstants lame;
  std::string names = "innermap";
};

void addEvaluationOptions(Command& command, EvaluationOptions& options);

MapGridSettings mapGridSettings(const EvaluationOptions& options, const Context& context);

// Throws MemoryError, with the highest --resolution that would fit, when the need is over the
// limit.
void requireEvaluationMemory(const Solid& solid, const MapGridSettings& settings);

void writeGrids(const std::string& path, const openvdb::GridPtrVec& grids,
                const EvaluationOptions& options, Context& context);

}  // namespace innermap::tool
