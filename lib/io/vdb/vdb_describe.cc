#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "innermap/core/memory.h"
#include "innermap/io/vdb_file.h"

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

using Entry = std::pair<std::string, std::string>;

std::vector<Entry> entriesOf(const VdbGridInfo& g) {
  std::vector<Entry> entries;
  if (!g.grid) return entries;
  for (auto it = g.grid->beginMeta(); it != g.grid->endMeta(); ++it)
    entries.emplace_back(it->first, it->second ? it->second->str() : "");
  return entries;
}

// What several grids all say alike.
std::vector<Entry> commonEntries(const VdbInfo& info) {
  std::vector<Entry> common;
  if (info.grids.size() < 2) return common;
  common = entriesOf(info.grids.front());
  for (const VdbGridInfo& grid : info.grids) {
    const std::vector<Entry> own = entriesOf(grid);
    common.erase(std::remove_if(common.begin(), common.end(),
                                [&](const Entry& e) {
                                  return std::find(own.begin(), own.end(), e) == own.end();
                                }),
                 common.end());
  }
  return common;
}

std::string entriesText(const std::vector<Entry>& entries, const std::vector<Entry>& but,
                        const std::string& indent) {
  std::string text;
  for (const Entry& e : entries)
    if (std::find(but.begin(), but.end(), e) == but.end())
      text += fmt::format("{}{}: {}\n", indent, e.first, e.second);
  return text;
}

std::string gridText(const VdbGridInfo& g, bool metadata, const std::vector<Entry>& common) {
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
  return metadata ? text + entriesText(entriesOf(g), common, "      ") : text;
}

}  // namespace

std::string describe(const VdbInfo& info, const std::string& path, bool metadata) {
  std::string text = fmt::format("{}: OpenVDB {}, {} grid{}\n", path, info.version,
                                 info.grids.size(), info.grids.size() == 1 ? "" : "s");
  const std::vector<Entry> common = commonEntries(info);
  for (const VdbGridInfo& grid : info.grids) text += "  " + gridText(grid, metadata, common);
  if (metadata && !common.empty()) text += "  in all grids:\n" + entriesText(common, {}, "    ");
  return text + metadataText(info.metadata, "  ");
}

std::uint64_t readMemory(const VdbInfo& info, const std::vector<std::string>& names) {
  std::uint64_t need = 0;
  for (const VdbGridInfo& grid : info.grids)
    if (names.empty() || std::find(names.begin(), names.end(), grid.name) != names.end())
      need += grid.memory;
  return need;
}

}  // namespace innermap
