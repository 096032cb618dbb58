// Slices of grids as one multi-part EXR file.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <string>
#include <vector>

#include "innermap/core/setting.h"

namespace innermap {

struct ExrSliceSettings {
  int axis = 2;       // 0, 1, 2: x, y, z
  int count = 16;     // slices, in [1, 65536]
  bool half = false;  // half floats: half the size, 3 digits, values clamped to 65,504
};

std::vector<Setting> describe(ExrSliceSettings& settings);

struct ExrSliceResult {
  int slices = 0;           // fewer than asked for when the box has fewer layers of voxels
  std::size_t clamped = 0;  // values that do not fit a half float
  std::size_t columns = 0, rows = 0;
};

// Writes one part a slice, named "z_0007" by axis and number of the slice in order. The layers are
// those of sliceLayers(), cropped to the common active box; the channels those of channelNames(),
// and `mask.V` (1 in voxels that are active in some grid) when there is neither a `surface` nor a
// `density` grid to tell where the solid is. Scanline parts, ZIP compression (lossless).
//
// Attributes of each part: `sliceAxis` (string), `sliceIndex` (layer in the grids' index space),
// `slicePosition` (double, world coordinate along the axis), `sliceCount`, `voxelSize` (double,
// world), `imageToWorld` (m44d, row vectors: (column, row, 0, 1) * imageToWorld is the world
// position of that pixel's centre), `software`.
//
// The file appears whole or not at all. Throws FileError, DataError, MemoryError (before
// allocating), SettingError, Cancelled.
ExrSliceResult writeExrSlices(const std::string& path, const openvdb::GridPtrVec& grids,
                              const ExrSliceSettings& settings = {});

// Peak need of writeExrSlices beside the grids, bytes.
std::uint64_t exrSliceMemory(const openvdb::GridPtrVec& grids, const ExrSliceSettings& settings);

// What an EXR file says of one of its parts, without its pixels.
struct ExrPart {
  std::string name;
  int width = 0, height = 0;
  std::vector<std::string> channels;
};

// Throws FileError.
std::vector<ExrPart> readExrInfo(const std::string& path);

// For a terminal, a line a part.
std::string describe(const std::vector<ExrPart>& parts, const std::string& path);

}  // namespace innermap
