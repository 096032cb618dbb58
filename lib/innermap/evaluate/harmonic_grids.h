// A harmonic field on the voxels of its solid: values, gradients, their directions and lengths.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <string>
#include <vector>

#include "innermap/core/stage_seconds.h"
#include "innermap/field/field_file.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/levelset/solid.h"

namespace innermap {

struct HarmonicGridSettings {
  int resolution = 128;  // voxels along the longest side of the solid, in [4, 4096]
  double voxelSize = 0;  // world units; above 0: in place of the resolution
  bool values = true, gradients = true, directions = true, magnitudes = true;
  double accuracy = 1e-7;  // of the sums, fraction of `span`, in [1e-12, 1e-3]
  double span = 1;         // of the values, in their units, above 0
};

struct HarmonicGrids {
  openvdb::FloatGrid::Ptr surface, density;  // level set, and fog of the inside
  // Of each channel, in order, what was asked for: NAME (float), NAME_gradient (vec3s, values'
  // units per world unit), NAME_direction (its unit vector; 0 where it is 0), NAME_magnitude (its
  // length). Active inside and in a skin of two voxels, where values go on from the closest point
  // of the boundary, as those of maps do (MapGrids). Background 0.
  openvdb::GridPtrVec fields;
  std::uint64_t activeVoxels = 0, interiorVoxels = 0;
  double voxelSize = 0;  // world units
  std::vector<std::string> warnings;
  StageSeconds seconds;  // "voxelize", "evaluate"

  openvdb::GridPtrVec all() const;
};

// names: of the channels. Throws SettingError (a setting out of range; names that are empty, twice,
// or not one a channel), MemoryError, DataError (thinner than the voxels everywhere), Cancelled.
// The same for any number of threads.
HarmonicGrids evaluateHarmonic(const HarmonicField& field, const Solid& solid,
                               const std::vector<std::string>& names,
                               const HarmonicGridSettings& settings = {});

// The field's facts as metadata of its grids (prefix innermap_).
void describeField(const openvdb::GridPtrVec& grids, const Facts& facts);

// Need in bytes of the grids of so many channels.
std::uint64_t harmonicGridMemory(const Solid& solid, std::size_t channels,
                                 const HarmonicGridSettings& settings = {});

}  // namespace innermap
