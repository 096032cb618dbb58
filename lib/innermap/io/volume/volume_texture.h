// Grids as volume textures: dense boxes of voxels in EXR files, for engines and renderers that read
// no OpenVDB. volume_texture_read.h reads them back.
#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "innermap/core/progress.h"

namespace innermap {

// kAtlas: all slices as tiles of one picture, row-major from the top left, first slice first.
// kSlices: a file a slice. kParts: one file, a part a slice.
enum class VolumeLayout { kAtlas, kSlices, kParts };

// "atlas", "slices", "parts"; throws SettingError for other texts.
VolumeLayout parseVolumeLayout(const std::string& setting, const std::string& text);
std::string volumeLayoutName(VolumeLayout layout);

// kAuto: as kRgba where the channels are four at most, else as kLayers.
// kRgba: one scalar is Y (grey); two are R, G; three or a vector R, G, B; a vector and a scalar, in
//        any order, R, G, B and A; else scalars are R, G, B, A in order.
// kLayers: those of slice.h: density.V, map.X, Cd.R.
enum class VolumeChannels { kAuto, kRgba, kLayers };

struct VolumeTextureSettings {
  VolumeLayout layout = VolumeLayout::kAtlas;
  int axis = 2;         // across the slices: 0, 1, 2 for x, y, z; columns and rows as in slice.h
  bool rowsUp = false;  // whether the first row of a slice has the largest index, not the least
  VolumeChannels channels = VolumeChannels::kAuto;
  bool half = false;    // half floats: 3 digits, values clamped to 65,504
  bool active = false;  // also NAME.active for each grid: 1 where a voxel is active
  int pad = 0;          // voxels of the grids about their active box, in [0, 4096]
  bool cube = false;    // the box grows to a cube about its middle
  int resolution = 0;   // voxels along the longest side, resampled, in [1, 8192]; 0: the grids'
  bool powerOfTwo =
      false;  // the box grows: slices, their sides and the picture's are powers of two
  std::optional<std::pair<int, int>> tiles;  // columns and rows of the atlas; unset: near a square
  std::uint64_t maxMemory = 0;               // bytes; 0 means no limit
  Progress* progress = nullptr;
};

struct VolumeTextureResult {
  std::vector<std::string> files;     // one, or one a slice
  std::vector<std::string> channels;  // in the order of the grids
  int width = 0, height = 0;          // of a picture, pixels
  int tileColumns = 1, tileRows = 1;
  int slices = 0, tileWidth = 0, tileHeight = 0;
  openvdb::Coord resolution;  // voxels of the dense box along x, y, z
  openvdb::BBoxd worldBox;
  std::size_t clamped = 0;  // values beyond the pixel type's largest number
  std::size_t inexact = 0;  // whole numbers that the pixel type does not have
};

// The dense box is the common active box of all grids (with pad, cube, resolution, powerOfTwo
// applied in this order); voxels that are not active have the grid's background, inside a level set
// minus that. Empty tiles at the end of an atlas have the background too. With `resolution`, float
// and vector values are interpolated linearly, as the mean over the new voxel when that is larger,
// whole numbers and truth values are the nearest voxel's.
// Scanline files, ZIP compression (lossless), one data window. The attributes of each part (see
// volume_attributes.h) tell layout, tiles, order, box, matrices and what the grids are.
//
// kSlices: `path` has the number's place as #### or %04d in its last component, else .0000 is put
// before the extension; numbers start at 0. All files appear whole or none does.
//
// Throws DataError (no grids, no active voxel, different transforms, a type without numbers, too
// many voxels), SettingError, MemoryError (before allocating), FileError, Cancelled.
VolumeTextureResult writeVolumeTexture(const std::string& path, const openvdb::GridPtrVec& grids,
                                       const VolumeTextureSettings& settings = {});

// What writeVolumeTexture would write: its result but for the counts. Throws as that does.
VolumeTextureResult planVolumeTexture(const std::string& path, const openvdb::GridPtrVec& grids,
                                      const VolumeTextureSettings& settings = {});

// Peak need of writeVolumeTexture beside the grids, bytes.
std::uint64_t volumeTextureMemory(const openvdb::GridPtrVec& grids,
                                  const VolumeTextureSettings& settings = {});

}  // namespace innermap
