// What VTK's XML image data say of themselves: "VTK File Formats", XML.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/file_bytes.h"
#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "io/cells/detail/xml_tags.h"
#include "io/volume/detail/volume_file_info.h"

namespace innermap {
namespace {

constexpr std::size_t kHead = std::size_t(1) << 24;  // bytes that tags are looked for in

std::vector<double> numbersOf(const std::string& path, const XmlTag& tag, const char* name,
                              const std::vector<double>& missing) {
  const std::string text = tag.attribute(name);
  if (text.empty()) return missing;
  std::vector<double> out;
  std::size_t at = 0;
  while ((at = text.find_first_not_of(" \t\r\n", at)) != text.npos) {
    const std::size_t end = std::min(text.find_first_of(" \t\r\n", at), text.size());
    const auto number = parseNumber(std::string_view(text).substr(at, end - at));
    if (!number || !(std::abs(*number) < 1e30))
      throw FileError(path, fmt::format("{} is not all numbers: damaged", name));
    out.push_back(*number);
    at = end;
  }
  if (out.size() != missing.size())
    throw FileError(path,
                    fmt::format("{} has {} numbers, not {}", name, out.size(), missing.size()));
  return out;
}

// Of the tag ImageData.
void place(const std::string& path, const XmlTag& tag, openvdb::Coord& size,
           openvdb::Mat4d& indexToWorld) {
  const auto extent = numbersOf(path, tag, "WholeExtent", {0, -1, 0, -1, 0, -1});
  const auto origin = numbersOf(path, tag, "Origin", {0, 0, 0});
  const auto spacing = numbersOf(path, tag, "Spacing", {1, 1, 1});
  const auto direction = numbersOf(path, tag, "Direction", {1, 0, 0, 0, 1, 0, 0, 0, 1});
  indexToWorld = openvdb::Mat4d::identity();
  for (std::size_t a = 0; a < 3; ++a) {
    const double points = extent[2 * a + 1] - extent[2 * a] + 1;
    if (!(points >= 1 && points < 1e9)) throw FileError(path, "has no points, or a damaged extent");
    size[int(a)] = static_cast<int>(points);
    for (std::size_t r = 0; r < 3; ++r)
      indexToWorld[int(a)][int(r)] = direction[3 * r + a] * spacing[a];
  }
  openvdb::Vec3d corner(extent[0], extent[2], extent[4]);
  corner = indexToWorld.transform3x3(corner) + openvdb::Vec3d(origin[0], origin[1], origin[2]);
  for (int r = 0; r < 3; ++r) indexToWorld[3][r] = corner[r];
}

}  // namespace

VolumeFileInfo vtiInfo(const std::string& path) {
  FileBytes head{path, ""};
  {
    const OpenFile file(path, "a VTK file");
    head.bytes.resize(std::min<std::uint64_t>(file.size(), kHead));
    file.read(0, head.bytes.data(), head.bytes.size());
  }
  VolumeFileInfo info;
  bool image = false, inPoints = false;
  openvdb::Coord size;
  openvdb::Mat4d indexToWorld;
  XmlTags tags(head);
  XmlTag tag;
  while (tags.next(tag) && tag.name != "AppendedData") {
    if (tag.name == "ImageData" && !tag.closing) {
      place(path, tag, size, indexToWorld);
      image = true;
    }
    if (tag.name == "PointData") inPoints = !tag.closing;
    if (tag.name == "Piece" && tag.closing) break;
    if (tag.name != "DataArray" || tag.closing || !inPoints || !image) continue;
    VolumeFileInfo::Grid grid;
    grid.name = tag.attribute("Name");
    grid.type = tag.attribute("type");
    if (const std::string n = tag.attribute("NumberOfComponents"); !n.empty() && n != "1")
      grid.type += " x " + n;
    grid.resolution = size;
    grid.voxelSize = openvdb::Vec3d(0);
    for (int a = 0; a < 3; ++a) {
      const openvdb::Vec4d row = indexToWorld.row(a);
      (*grid.voxelSize)[a] = openvdb::Vec3d(row[0], row[1], row[2]).length();
    }
    grid.worldBox = boxOf(indexToWorld, size);
    info.grids.push_back(grid);
  }
  if (!image) throw FileError(path, "is no VTK image data, or a damaged file");
  return info;
}

}  // namespace innermap
