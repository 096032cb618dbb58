// Volume textures back into grids: what volume_texture.h writes, and atlases, slices and parts of
// other programs.
#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "innermap/core/progress.h"
#include "innermap/core/vec3.h"
#include "innermap/io/volume/volume_texture.h"

namespace innermap {

// What the file's attributes do not say, or what counts in their place. The messages of errors call
// the settings by the options of `innermap import`: --tiles, --voxel-size and so on.
struct VolumeTextureReadSettings {
  // Of a file that says what its grids are: those to read, empty for all. Else the names of its
  // grids: one for each (R, G, B together and X, Y, Z of one layer are a vector, others scalars),
  // vectors before scalars, or one for each channel in the file's order.
  std::vector<std::string> names;
  std::optional<VolumeLayout> layout;
  std::optional<std::pair<int, int>> tiles;  // columns and rows of an atlas
  std::optional<int> slices;                 // without, all tiles
  std::optional<int> axis;                   // across the slices, 0, 1, 2; without, z
  std::optional<bool> rowsUp;                // see VolumeTextureSettings; without, false
  std::optional<double> voxelSize;           // world units
  Vec3 lowerCorner;                      // world position of the box's least corner, with voxelSize
  std::optional<double> background;      // of all grids
  std::optional<std::string> gridClass;  // "level set", "fog volume", "unknown", ...
  std::uint64_t maxMemory = 0;           // bytes; 0 means no limit
  Progress* progress = nullptr;
};

struct VolumeTextureContents {
  openvdb::GridPtrVec grids;
  VolumeLayout layout = VolumeLayout::kAtlas;
  openvdb::Coord resolution;  // of the dense box
  std::size_t notFinite = 0;  // values that are infinite or no numbers
};

// `path`: an atlas or a file of parts; for slices a pattern (#### or %04d) or any of the files.
// Grids have the type, name, class, background, vector type and transform that the attributes say.
// A voxel is active where NAME.active says so or, without that channel, where its value is not the
// background as the pixel type holds that; in level sets, not plus or minus that. What is not
// active has the background exactly; uniform blocks of 8^3 voxels become tiles.
//
// Files are not trusted. Throws FileError for what cannot be read, for a missing attribute (naming
// the option that gives it) and for attributes that contradict one another or the pixels;
// MemoryError before allocating; SettingError; Cancelled.
VolumeTextureContents readVolumeTexture(const std::string& path,
                                        const VolumeTextureReadSettings& settings = {});

// What readVolumeTexture would read, without reading pixels. Throws as that does.
struct VolumeTextureNeed {
  openvdb::Coord resolution;
  std::uint64_t memory = 0;  // bytes, when all voxels are active; less when few are
};
VolumeTextureNeed volumeTextureReadNeed(const std::string& path,
                                        const VolumeTextureReadSettings& settings = {});

}  // namespace innermap
