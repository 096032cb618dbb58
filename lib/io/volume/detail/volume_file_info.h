// readVolumeFileInfo() of each format; without the format's name. Each throws FileError.
#pragma once

#include <string>

#include "innermap/io/volume_texture.h"

namespace innermap {

VolumeFileInfo nanoVdbInfo(const std::string& path);
VolumeFileInfo ddsInfo(const std::string& path);
VolumeFileInfo vtiInfo(const std::string& path);
VolumeFileInfo niftiInfo(const std::string& path);
VolumeFileInfo usdInfo(const std::string& path);

// The box by outer faces of voxels 0 to size - 1, row vectors.
openvdb::BBoxd boxOf(const openvdb::Mat4d& indexToWorld, const openvdb::Coord& size);

}  // namespace innermap
