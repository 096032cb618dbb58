// A map on the voxels of its solid, as grids with their metadata: what `evaluate` and `map` share.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <optional>
#include <string>

#include "boundary_pair.h"
#include "command.h"
#include "innermap/evaluate/evaluate_map.h"
#include "innermap/field/field_file.h"

namespace innermap::tool {

struct EvaluationOptions {
  int resolution = 128;
  std::optional<double> voxelSize;
  LameConstants lame;
  std::string names = "innermap";
};

void addEvaluationOptions(Command& command, EvaluationOptions& options);

// Peak need in bytes, from the solid's volume and area.
std::uint64_t evaluationMemory(const Solid& solid, const EvaluationOptions& options);

// Throws MemoryError, with the highest --resolution that would fit, when the need is over the
// limit.
void requireEvaluationMemory(const Solid& solid, const EvaluationOptions& options,
                             const Context& context);

// Grids surface, density, map, jacobian, harmonic_energy, deformation_energy, with the map's
// settings, its certificate and the totals in their metadata (prefix innermap_). Fills the report's
// "energy", "jacobian" and "grid".
openvdb::GridPtrVec evaluateGrids(const BoundaryPair& pair, const FieldFile& file,
                                  const EvaluationOptions& options, Context& context);

void writeGrids(const std::string& path, const openvdb::GridPtrVec& grids,
                const EvaluationOptions& options, Context& context);

// "harmonic energy ..., folded ..." for the terminal, from the report.
std::string evaluationText(const Report& report);

}  // namespace innermap::tool
