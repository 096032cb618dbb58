// `innermap info`: what a file holds.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "commands.h"
#include "innermap/core/memory.h"
#include "innermap/field/field_file.h"
#include "innermap/io/exr/exr_info.h"
#include "innermap/io/vdb/vdb_file.h"
#include "innermap/mesh/read.h"

namespace innermap::tool {
namespace {

struct InfoOptions {
  std::string file;
  bool metadata = false;
};

std::string extension(const std::string& path) {
  std::string e = std::filesystem::path(path).extension().string();
  std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return std::tolower(c); });
  return e;
}

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

void vdbInfo(const InfoOptions& options, Context& context) {
  const VdbInfo info = readVdbInfo(options.file, {context.progress()});
  std::string text = fmt::format("{}: OpenVDB {}, {} grid{}\n", options.file, info.version,
                                 info.grids.size(), info.grids.size() == 1 ? "" : "s");
  text += metadataText(info.metadata, "  ");
  for (const VdbGridInfo& grid : info.grids) text += "  " + gridText(grid, options.metadata);
  context.print(text);
}

void meshInfo(const InfoOptions& options, Context& context) {
  ReadSettings settings;
  settings.progress = context.progress();
  const Mesh mesh = readMesh(options.file, settings);
  const Box3 box = boundingBox(mesh);
  const Vec3 size = box.extent();
  std::string text = fmt::format("{}: mesh, {} vertices, {} triangles", options.file,
                                 mesh.vertices.size(), mesh.triangles.size());
  if (mesh.polygonStart.size() > 1)
    text += fmt::format(" from {} polygons", mesh.polygonStart.size() - 1);
  if (!mesh.uvs.empty()) text += fmt::format(", {} texture coordinates", mesh.uvs.size());
  if (!mesh.colours.empty()) text += ", vertex colours";
  text += fmt::format(
      "\n  box ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}), {:.6g} x {:.6g} x {:.6g}, "
      "diagonal {:.6g}\n  area {:.6g}, volume {:.6g}\n",
      box.lower.x, box.lower.y, box.lower.z, box.upper.x, box.upper.y, box.upper.z, size.x, size.y,
      size.z, box.diagonal(), surfaceArea(mesh), signedVolume(mesh));
  context.print(text);
}

void mapInfo(const InfoOptions& options, Context& context) {
  const FieldFile file = readField(options.file);
  std::string text = fmt::format(
      "{}: harmonic field, {} channel{}, {} charges, boundary of {} vertices and {} triangles\n",
      options.file, file.field.channels(), file.field.channels() == 1 ? "" : "s",
      file.field.sources().size(), file.boundary.size(), file.boundaryTriangles.size());
  for (const auto& [key, value] : file.settings) text += fmt::format("    {}: {}\n", key, value);
  context.print(text);
}

void exrInfo(const InfoOptions& options, Context& context) {
  std::string text;
  const std::vector<ExrPart> parts = readExrInfo(options.file);
  text +=
      fmt::format("{}: EXR, {} part{}\n", options.file, parts.size(), parts.size() == 1 ? "" : "s");
  for (const ExrPart& part : parts)
    text += fmt::format("  {}{}{} x {}: {}\n", part.name, part.name.empty() ? "" : ": ", part.width,
                        part.height, fmt::join(part.channels, ", "));
  context.print(text);
}

void run(const InfoOptions& options, Context& context) {
  if (context.dryRun()) return context.plan({"describe " + options.file}, 0);
  const std::string e = extension(options.file);
  if (e == ".vdb") return vdbInfo(options, context);
  if (e == ".exr") return exrInfo(options, context);
  if (isFieldFile(options.file)) return mapInfo(options, context);
  meshInfo(options, context);
}

}  // namespace

Command makeInfoCommand() {
  auto o = std::make_shared<InfoOptions>();
  Command c("info", "Say what is in a file: grids, a map, a mesh, or EXR parts");
  c.positional("FILE", &o->file, "a .vdb, .exr, map or mesh file");
  c.flag("--metadata", &o->metadata, "all metadata of each grid");
  c.example("innermap info map.vdb");
  c.run([o](Context& context) { run(*o, context); });
  return c;
}

}  // namespace innermap::tool
