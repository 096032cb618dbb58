// What a volume texture will be: its lattice, its channels, where the values come from.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "innermap/io/volume_texture.h"
#include "io/volume/detail/volume_attributes.h"
#include "io/volume/detail/volume_lattice.h"
#include "io/volume/detail/volume_sampler.h"

namespace innermap {

struct VolumePlan {
  VolumeLattice lattice;
  std::vector<VolumeGrid> grids;
  std::vector<std::unique_ptr<VolumeSampler>> samplers;  // of each grid
  std::vector<std::string> channels;                     // all, grid after grid
  std::vector<float> fill;                               // of each channel, for empty tiles
  bool half = false;

  int width() const { return lattice.width() * lattice.tileColumns; }  // of a picture
  int height() const { return lattice.height() * lattice.tileRows; }
};

// The samplers refer to the grids. Throws DataError, SettingError.
VolumePlan makeVolumePlan(const openvdb::GridPtrVec& grids, const VolumeTextureSettings& settings);

}  // namespace innermap
