#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "innermap/core/error.h"
#include "innermap/io/pictures.h"
#include "innermap/io/volume_texture.h"
#include "io/exr/detail/exr_stream.h"
#include "io/volume/detail/volume_attributes.h"

namespace innermap {
namespace {

constexpr int kMostAcross = 1 << 24, kFarthest = 1 << 30;

// Numbers that a box can be made of; files are not trusted.
bool isSound(const VolumeAttributes& a) {
  if (!a.layout || !a.axis || !a.resolution || !a.indexMin || !a.indexToWorld) return false;
  for (int k = 0; k < 3; ++k) {
    const int across = (*a.resolution)[k], from = (*a.indexMin)[k];
    if (across < 1 || across > kMostAcross || from < -kFarthest || from > kFarthest) return false;
  }
  for (int i = 0; i < 16; ++i)
    if (!std::isfinite(a.indexToWorld->asPointer()[i])) return false;
  return true;
}

}  // namespace

std::optional<VolumeTextureInfo> readVolumeTextureInfo(const std::string& path) {
  VolumeAttributes a;
  withExrErrors(path, "read", "", [&] {
    const Imf::MultiPartInputFile file(path.c_str(), 0, /*reconstructChunkOffsetTable=*/false);
    a = readVolumeAttributes(path, file.header(0));
  });
  if (!isSound(a)) return std::nullopt;
  VolumeLattice lattice;
  lattice.setAxis(*a.axis);
  lattice.origin = *a.indexMin;
  lattice.size = *a.resolution;
  lattice.indexToWorld = *a.indexToWorld;
  VolumeTextureInfo info;
  info.layout = *a.layout;
  info.axis = *a.axis;
  info.rowsUp = a.rowsUp.value_or(false);
  if (a.tiles) {
    info.tileColumns = a.tiles->x();
    info.tileRows = a.tiles->y();
  }
  info.tileWidth = a.tileSize ? a.tileSize->x() : lattice.width();
  info.tileHeight = a.tileSize ? a.tileSize->y() : lattice.height();
  info.slices = a.sliceCount.value_or(lattice.slices());
  info.resolution = lattice.size;
  info.worldBox = lattice.worldBox();
  for (int k = 0; k < 3; ++k) {
    const auto row = a.indexToWorld->row(k);
    info.voxelSize[k] = std::sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2]);
  }
  for (const VolumeGrid& g : a.grids)
    info.grids.push_back({g.name, g.type, g.gridClass, g.channels});
  return info;
}

std::string describe(const VolumeTextureInfo& info) {
  const openvdb::Vec3d low = info.worldBox.min(), high = info.worldBox.max(), v = info.voxelSize;
  std::string text = fmt::format("  volume texture: {}", info.layout);
  if (info.layout == "atlas")
    text += fmt::format(" of {} x {} tiles", info.tileColumns, info.tileRows);
  text +=
      fmt::format(", {} slices of {} x {} pixels along {}, rows {}\n", info.slices, info.tileWidth,
                  info.tileHeight, axisName(info.axis), info.rowsUp ? "up" : "down");
  const std::string size = v.eq(openvdb::Vec3d(v.x()), 1e-9 * std::abs(v.x()))
                               ? fmt::format("{:.6g}", v.x())
                               : fmt::format("{:.6g} x {:.6g} x {:.6g}", v.x(), v.y(), v.z());
  text += fmt::format(
      "  {} x {} x {} voxels of {}, box ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})\n",
      info.resolution.x(), info.resolution.y(), info.resolution.z(), size, low.x(), low.y(),
      low.z(), high.x(), high.y(), high.z());
  for (const VolumeTextureInfo::Grid& g : info.grids)
    text += fmt::format("  {}: {}{} in {}\n", g.name, g.type,
                        g.gridClass.empty() || g.gridClass == "unknown" ? "" : ", " + g.gridClass,
                        fmt::join(g.channels, ", "));
  return text;
}

}  // namespace innermap
