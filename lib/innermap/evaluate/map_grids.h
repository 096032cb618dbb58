// A map on the voxels of its solid, ready to be written: level set, fog, positions, Jacobian and
// energies, with the map's facts in their metadata.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <string>
#include <vector>

#include "innermap/boundary/mapped_solid.h"
#include "innermap/core/stage_seconds.h"
#include "innermap/evaluate/energy.h"
#include "innermap/evaluate/evaluate_map.h"

namespace innermap {

struct MapGridSettings {
  int resolution = 128;  // voxels along the longest side of the solid, in [4, 4096]
  double voxelSize = 0;  // world units; above 0: in place of the resolution
  LameConstants lame;
  std::uint64_t maxMemory = 0;  // bytes; 0 means no limit
  Progress* progress = nullptr;
};

struct SolidGrids {
  openvdb::FloatGrid::Ptr surface, density;  // level set, and fog of the inside
  MapGrids values;                           // with their totals
  double voxelSize = 0;                      // world units
  std::vector<std::string> notes, warnings;
  StageSeconds seconds;  // "voxelize", "evaluate"

  // surface, density, map, jacobian, harmonic_energy, deformation_energy.
  openvdb::GridPtrVec all() const;
};

// Metadata (prefix innermap_): the map's facts, harmonic_energy_total, deformation_energy_total,
// jacobian_min, jacobian_max, folded_fraction, lame_lambda, lame_mu. Throws SettingError,
// MemoryError, DataError (thinner than the voxels everywhere), Cancelled. Deterministic for any
// number of threads.
SolidGrids evaluateOnGrid(const MappedSolid& mapped, const MapGridSettings& settings = {});

// Peak need in bytes, from the solid's volume and area.
std::uint64_t mapGridMemory(const Solid& solid, const MapGridSettings& settings);

// The map's facts as metadata of grids made with it (prefix innermap_).
void describeMap(const openvdb::GridPtrVec& grids, const MappedSolid& mapped);

}  // namespace innermap
