// What files that hold grids for other programs say of themselves.
#include "io/volume/detail/volume_file_info.h"

#include <fmt/format.h>

#include <map>

#include "core/byte_order.h"
#include "core/file_bytes.h"
#include "innermap/core/error.h"
#include "innermap/io/volume_texture.h"

namespace innermap {
namespace {

using Grid = VolumeFileInfo::Grid;

std::string axesText(const openvdb::Vec3d& v) {
  return v.eq(openvdb::Vec3d(v.x()), 1e-9)
             ? fmt::format("{:.6g}", v.x())
             : fmt::format("{:.6g} x {:.6g} x {:.6g}", v.x(), v.y(), v.z());
}

std::string placeText(const openvdb::Vec3d& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z());
}

}  // namespace

openvdb::BBoxd boxOf(const openvdb::Mat4d& indexToWorld, const openvdb::Coord& size) {
  openvdb::BBoxd box;
  for (int corner = 0; corner < 8; ++corner) {
    openvdb::Vec3d at;
    for (int a = 0; a < 3; ++a) at[a] = corner >> a & 1 ? size[a] - 0.5 : -0.5;
    box.expand(indexToWorld.transform(at));
  }
  return box;
}

namespace {

std::string gridText(const Grid& grid) {
  std::string text = "  " + (grid.name.empty() ? "values" : grid.name);
  text += grid.type.empty() ? "" : ": " + grid.type;
  text += grid.gridClass.empty() ? "" : ", " + grid.gridClass;
  const openvdb::Coord& n = grid.resolution;
  if (n != openvdb::Coord(0)) text += fmt::format(", {} x {} x {} voxels", n.x(), n.y(), n.z());
  if (grid.activeVoxels) text += fmt::format(", {} active", *grid.activeVoxels);
  if (grid.voxelSize) text += ", voxel size " + axesText(*grid.voxelSize);
  if (grid.worldBox)
    text +=
        "\n    box " + placeText(grid.worldBox->min()) + " to " + placeText(grid.worldBox->max());
  if (!grid.files.empty())
    text += fmt::format("\n    {}{}", grid.files.front(),
                        grid.files.size() == 1 ? std::string()
                                               : fmt::format(" to {}, {} files", grid.files.back(),
                                                             grid.files.size()));
  return text + "\n";
}

}  // namespace

// Microsoft, "DDS_HEADER" and "DDS_HEADER_DXT10".
VolumeFileInfo ddsInfo(const std::string& path) {
  constexpr std::size_t kHeader = 148;
  const OpenFile file(path, "a DDS texture");
  char bytes[kHeader];
  if (file.size() < 128) throw FileError(path, "is cut short; export it again");
  file.read(0, bytes, file.size() < kHeader ? 128 : kHeader);
  const auto word = [&](std::size_t i) { return numberAt<std::uint32_t>(bytes + 4 * i); };
  const auto isText = [&](std::size_t i, const char* text) {
    return std::string(bytes + 4 * i, 4) == text;
  };
  if (!isText(0, "DDS ") || word(1) != 124) throw FileError(path, "is no DDS texture");
  VolumeFileInfo info;
  constexpr std::uint32_t kVolume = 0x200000, kMost = 1u << 24;
  for (const std::size_t i : {3, 4, 6})
    if (word(i) > kMost) throw FileError(path, "has sides beyond all textures: damaged");
  const auto side = [&](std::size_t i) { return static_cast<int>(word(i)); };
  Grid grid;
  grid.resolution = {side(4), side(3), word(28) & kVolume ? side(6) : 1};
  static const std::map<std::uint32_t, const char*> kNames{
      {2, "RGBA32F"}, {10, "RGBA16F"}, {16, "RG32F"}, {34, "RG16F"}, {41, "R32F"}, {54, "R16F"}};
  if (isText(21, "DX10")) {
    if (file.size() < kHeader) throw FileError(path, "is cut short; export it again");
    const auto name = kNames.find(word(32));
    grid.type = name == kNames.end() ? fmt::format("DXGI format {}", word(32)) : name->second;
  }
  info.grids.push_back(grid);
  return info;
}

std::string describe(const VolumeFileInfo& info, const std::string& path) {
  std::string text = fmt::format("{}: {}, {} grid{}\n", path, info.format, info.grids.size(),
                                 info.grids.size() == 1 ? "" : "s");
  for (const Grid& grid : info.grids) text += gridText(grid);
  for (const auto& [key, value] : info.facts) text += fmt::format("  {}: {}\n", key, value);
  return text;
}

}  // namespace innermap
