// What a volume texture says of itself in EXR attributes.
//
//   volumeLayout        string   "atlas", "slices", "parts"
//   volumeAxis          string   "x", "y", "z": across the slices; slices ascend along it
//   volumeColumnAxis    string   along a row of pixels, ascending
//   volumeRowAxis       string   along a column of pixels
//   volumeRowOrder      string   "down": ascending from the first row on; "up": descending
//   volumeTileOrder     string   "row-major": tiles go right, then down, from the first row's left
//   volumeTiles         v2i      columns and rows of tiles
//   volumeTileSize      v2i      pixels of a tile, which is a slice
//   volumeSliceCount    int
//   volumeSliceIndex    int      of a slice in a file or part of its own, from 0
//   volumeResolution    v3i      voxels of the dense box along x, y, z
//   volumeIndexMin, volumeIndexMax   v3i   its corner voxels in index space, both inside
//   volumeWorldMin, volumeWorldMax   v3d   its axis-aligned box in world space, by outer faces
//   volumeVoxelSize     v3d      world units
//   indexToWorld        m44d     (i, j, k, 1) * indexToWorld is the centre of voxel i, j, k
//   textureToWorld      m44d     from the unit cube of texture coordinates along x, y, z
//   gridCount           int
//   gridN.name, .type, .class, .vectorType   string   of grid N, as OpenVDB has them
//   gridN.background    double or v3d
//   gridN.channel, or .channelX, .channelY, .channelZ   string   where its values stand
//   gridN.activeChannel string   1 where a voxel is active; absent unless asked for
#pragma once

#include <OpenEXR/ImfHeader.h>
#include <openvdb/openvdb.h>

#include <optional>
#include <string>
#include <vector>

#include "io/volume/detail/volume_lattice.h"

namespace innermap {

// A grid, and the channels that hold it.
struct VolumeGrid {
  std::string name, type = "float", gridClass = "unknown", vectorType = "invariant";
  openvdb::Vec3d background{0, 0, 0};  // a scalar's is the first
  std::vector<std::string> channels;   // one, or three
  std::string activeChannel;           // or empty

  bool isVector() const { return channels.size() == 3; }
  std::size_t channelCount() const { return channels.size() + (activeChannel.empty() ? 0 : 1); }
};

// Puts all attributes but volumeSliceIndex.
void insertVolumeAttributes(Imf::Header& header, const std::string& layout,
                            const VolumeLattice& lattice, const std::vector<VolumeGrid>& grids);

// What stands in a header; nothing is checked beyond its own range. Throws FileError naming `path`
// and the attribute for one of another type than above or without meaning.
struct VolumeAttributes {
  std::optional<std::string> layout;
  std::optional<int> axis;
  std::optional<bool> rowsUp;
  std::optional<openvdb::Vec2i> tiles, tileSize;
  std::optional<int> sliceCount, sliceIndex;
  std::optional<openvdb::Coord> resolution, indexMin, indexMax;
  std::optional<openvdb::Mat4d> indexToWorld;
  std::vector<VolumeGrid> grids;
};
VolumeAttributes readVolumeAttributes(const std::string& path, const Imf::Header& header);

}  // namespace innermap
