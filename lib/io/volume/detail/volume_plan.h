// What a volume texture will be: its lattice, its channels, where the values come from.
#pragma once

#include <cstdint>
#include <functional>
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
// The same of values as doubles hold them.
VolumePlan makeExactPlan(const openvdb::GridPtrVec& grids, const VolumeTextureSettings& settings);

// All channels of a slice of some of the plan's grids, one after the other: rows of width.
using SliceValues = std::vector<std::vector<double>>;

// Calls use(slice, values) for the slices in order, with the grids first ... end - 1 of the plan;
// the sampling runs on all threads. Reports progress of `stage`, an equal part of it for each
// of the plan's grids. Throws Cancelled.
PixelCounts forSlices(const VolumePlan& plan, std::size_t first, std::size_t end,
                      const std::string& stage,
                      const std::function<void(int slice, const SliceValues& values)>& use);
std::uint64_t sliceMemory(const VolumePlan& plan);  // bytes that forSlices takes

}  // namespace innermap
