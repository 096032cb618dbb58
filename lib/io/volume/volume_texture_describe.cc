#include <fmt/format.h>

#include <algorithm>

#include "innermap/io/pictures.h"
#include "innermap/io/volume_texture.h"

namespace innermap {
namespace {

// Of a file that has no pictures.
std::string describeFile(const VolumeTextureResult& r, const std::string& path) {
  std::string text = fmt::format("{}: {}, ", path, r.format);
  if (r.resolution != openvdb::Coord(0))
    text +=
        fmt::format("{} x {} x {} voxels, ", r.resolution.x(), r.resolution.y(), r.resolution.z());
  return text + fmt::format("{}\n", fmt::join(r.channels, ", "));
}

}  // namespace

std::string describe(const VolumeTextureResult& r, const std::string& path,
                     const VolumeTextureSettings& settings) {
  std::string text;
  if (r.slices == 0) return describeFile(r, path);
  if (settings.layout == VolumeLayout::atlas)
    text = fmt::format("{}: {} x {} tiles of {} x {}, {} x {} pixels", path, r.tileColumns,
                       r.tileRows, r.tileWidth, r.tileHeight, r.width, r.height);
  else if (settings.layout == VolumeLayout::parts)
    text = fmt::format("{}: {} parts of {} x {} pixels", path, r.slices, r.width, r.height);
  else
    text = fmt::format("{} to {}: {} x {} pixels each", r.files.front(), r.files.back(), r.width,
                       r.height);
  return text + fmt::format("\n{} slices along {}, {} x {} x {} voxels, channels {}\n", r.slices,
                            axisName(settings.axis), r.resolution.x(), r.resolution.y(),
                            r.resolution.z(), fmt::join(r.channels, ", "));
}

std::vector<std::string> warningsOf(const VolumeTextureResult& r, const std::string& path,
                                    const VolumeTextureSettings& settings) {
  constexpr int kLargestForEngines = 16384;  // pixels
  constexpr int kLargestVolume = 2048;       // voxels
  const char* const hint = settings.half ? "; leave out --half" : "";
  std::vector<std::string> out;
  if (r.clamped > 0)
    out.push_back(fmt::format("{}: {} values do not fit the pixels and were clamped{}", path,
                              r.clamped, hint));
  if (r.inexact > 0)
    out.push_back(fmt::format("{}: {} whole numbers were rounded: the pixels do not have them{}",
                              path, r.inexact, hint));
  if (std::max(r.width, r.height) > kLargestForEngines)
    out.push_back(
        fmt::format("{}: {} x {} pixels; engines take {} a side, use a lower "
                    "--resolution",
                    path, r.width, r.height, kLargestForEngines));
  const openvdb::Coord& size = r.resolution;
  if (r.format == "DDS" && std::max({size.x(), size.y(), size.z()}) > kLargestVolume)
    out.push_back(
        fmt::format("{}: {} x {} x {} voxels; Direct3D takes {} a side, use a lower --resolution",
                    path, size.x(), size.y(), size.z(), kLargestVolume));
  return out;
}

}  // namespace innermap
