#include <fmt/format.h>

#include <algorithm>

#include "innermap/core/memory.h"
#include "innermap/io/vdb/vdb_file.h"

namespace innermap {
namespace {

std::string boxText(const openvdb::Vec3i& lower, const openvdb::Vec3i& upper) {
  return fmt::format("({}, {}, {}) to ({}, {}, {})", lower.x(), lower.y(), lower.z(), upper.x(),
                     upper.y(), upper.z());
}

std::string metadataText(const openvdb::MetaMap& map, const std::string& indent) {
  std::string text;
  for (auto it = map.beginMeta(); it != map.endMeta(); ++it)
    text += fmt::format("{}{}: {}\n", indent, it->first, it->second ? it->second->str() : "");
  return text;
}

std::string transformText(const openvdb::math::Transform& transform) {
  const openvdb::Vec3d v = transform.voxelSize();
  const openvdb::Vec3d origin = transform.indexToWorld(openvdb::Vec3d(0.0));
  const std::string size = v.eq(openvdb::Vec3d(v.x()), 1e-9)
                               ? fmt::format("{:.6g}", v.x())
                               : fmt::format("{:.6g} x {:.6g} x {:.6g}", v.x(), v.y(), v.z());
  return fmt::format("voxel size {}, index origin at ({:.6g}, {:.6g}, {:.6g})", size, origin.x(),
                     origin.y(), origin.z());
}

std::string gridText(const VdbGridInfo& g, bool metadata) {
  std::string text =
      fmt::format("{}: {}{}, {} in the file, {} in memory\n", g.name, g.type,
                  g.gridClass.empty() || g.gridClass == "unknown" ? "" : ", " + g.gridClass,
                  formatBytes(g.bytes), formatBytes(g.memory));
  if (!g.grid) return text + "    a type that innermap does not read\n";
  const auto count = g.grid->getMetadata<openvdb::Int64Metadata>("file_voxel_count");
  const auto lower = g.grid->getMetadata<openvdb::Vec3IMetadata>("file_bbox_min");
  const auto upper = g.grid->getMetadata<openvdb::Vec3IMetadata>("file_bbox_max");
  if (count) text += fmt::format("    {} active voxels", count->value());
  if (count && count->value() > 0 && lower && upper)
    text += ", box " + boxText(lower->value(), upper->value());
  text += count ? "\n    " : "    ";
  text += transformText(g.grid->constTransform()) + "\n";
  if (metadata) {
    text += metadataText(*g.grid, "      ");
    return text;
  }
  for (auto it = g.grid->beginMeta(); it != g.grid->endMeta(); ++it)
    if (it->first.compare(0, 9, "innermap_") == 0)
      text += fmt::format("    {}: {}\n", it->first, it->second->str());
  return text;
}

}  // namespace

std::string describe(const VdbInfo& info, const std::string& path, bool metadata) {
  std::string text = fmt::format("{}: OpenVDB {}, {} grid{}\n", path, info.version,
                                 info.grids.size(), info.grids.size() == 1 ? "" : "s");
  text += metadataText(info.metadata, "  ");
  for (const VdbGridInfo& grid : info.grids) text += "  " + gridText(grid, metadata);
  return text;
}

std::uint64_t readMemory(const VdbInfo& info, const std::vector<std::string>& names) {
  std::uint64_t need = 0;
  for (const VdbGridInfo& grid : info.grids)
    if (names.empty() || std::find(names.begin(), names.end(), grid.name) != names.end())
      need += grid.memory;
  return need;
}

}  // namespace innermap
