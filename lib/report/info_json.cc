// What `innermap info --json` says of each kind of file.
#include "report/info_json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace innermap {
namespace {

using Json = nlohmann::ordered_json;

Json json(const Vec3& v) { return {v.x, v.y, v.z}; }
Json json(const openvdb::Vec3d& v) { return {v.x(), v.y(), v.z()}; }
Json json(const openvdb::Coord& c) { return {c.x(), c.y(), c.z()}; }

// Text of files may be anything.
std::string dumped(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json json(const openvdb::MetaMap& map) {
  Json out = Json::object();
  for (auto it = map.beginMeta(); it != map.endMeta(); ++it)
    out[it->first] = it->second ? it->second->str() : "";
  return out;
}

Json json(const VdbGridInfo& g) {
  Json out = {{"name", g.name},
              {"type", g.type},
              {"class", g.gridClass},
              {"bytes", g.bytes},
              {"memory", g.memory}};
  if (!g.grid) return out;
  if (const auto count = g.grid->getMetadata<openvdb::Int64Metadata>("file_voxel_count"))
    out["active_voxels"] = count->value();
  const auto lower = g.grid->getMetadata<openvdb::Vec3IMetadata>("file_bbox_min");
  const auto upper = g.grid->getMetadata<openvdb::Vec3IMetadata>("file_bbox_max");
  if (lower && upper) {
    const openvdb::Vec3i a = lower->value(), b = upper->value();
    out["box"] = {{a.x(), a.y(), a.z()}, {b.x(), b.y(), b.z()}};
  }
  out["voxel_size"] = json(g.grid->voxelSize());
  out["index_origin"] = json(g.grid->constTransform().indexToWorld(openvdb::Vec3d(0.0)));
  out["metadata"] = json(static_cast<const openvdb::MetaMap&>(*g.grid));
  return out;
}

Json json(const VolumeTextureInfo& v) {
  static const char* const kAxes[] = {"x", "y", "z"};
  Json out = {{"layout", v.layout},
              {"axis", kAxes[v.axis]},
              {"rows", v.rowsUp ? "up" : "down"},
              {"tiles", {v.tileColumns, v.tileRows}},
              {"tile_size", {v.tileWidth, v.tileHeight}},
              {"slices", v.slices},
              {"resolution", json(v.resolution)},
              {"voxel_size", json(v.voxelSize)},
              {"world_box", {json(v.worldBox.min()), json(v.worldBox.max())}},
              {"grids", Json::array()}};
  for (const auto& g : v.grids)
    out["grids"].push_back(
        {{"name", g.name}, {"type", g.type}, {"class", g.gridClass}, {"channels", g.channels}});
  return out;
}

}  // namespace

std::string infoJson(const std::string& path, const VdbInfo& info) {
  Json out = {{"file", path},
              {"kind", "vdb"},
              {"version", info.version},
              {"metadata", json(info.metadata)},
              {"grids", Json::array()}};
  for (const VdbGridInfo& grid : info.grids) out["grids"].push_back(json(grid));
  return dumped(out);
}

std::string infoJson(const std::string& path, const std::vector<ExrPart>& parts,
                     const std::optional<VolumeTextureInfo>& volume) {
  Json out = {{"file", path}, {"kind", "exr"}, {"parts", Json::array()}};
  for (const ExrPart& p : parts)
    out["parts"].push_back(
        {{"name", p.name}, {"width", p.width}, {"height", p.height}, {"channels", p.channels}});
  if (volume) out["volume_texture"] = json(*volume);
  return dumped(out);
}

std::string infoJson(const std::string& path, const FieldFile& file) {
  std::vector<std::size_t> charges;
  for (const HarmonicField& step : file.steps) charges.push_back(step.sources().size());
  Json out = {{"file", path},
              {"kind", "map"},
              {"channels", file.steps.front().channels()},
              {"charges", charges},
              {"boundary_vertices", file.boundary.size()},
              {"boundary_triangles", file.boundaryTriangles.size()},
              {"facts", Json::object()}};
  for (const auto& [key, value] : file.facts) out["facts"][key] = fmt::format("{}", value);
  return dumped(out);
}

std::string infoJson(const std::string& path, const Mesh& mesh) {
  const Box3 box = boundingBox(mesh);
  return dumped({{"file", path},
                 {"kind", "mesh"},
                 {"vertices", mesh.vertices.size()},
                 {"triangles", mesh.triangles.size()},
                 {"texture_coordinates", mesh.uvs.size()},
                 {"vertex_colours", !mesh.colours.empty()},
                 {"box", {json(box.lower), json(box.upper)}},
                 {"diagonal", box.diagonal()},
                 {"area", surfaceArea(mesh)},
                 {"volume", signedVolume(mesh)}});
}

std::string infoJson(const std::string& path, const AnimationInfo& info) {
  if (isGltf(path)) {
    Json out = {
        {"file", path}, {"kind", "gltf"}, {"meshes", Json::array()}, {"animations", Json::array()}};
    for (const AnimationInfo::Body& m : info.meshes)
      out["meshes"].push_back({{"name", m.name},
                               {"vertices", m.vertices},
                               {"stored_vertices", m.stored},
                               {"triangles", m.triangles},
                               {"joints", m.joints},
                               {"morph_targets", m.targets}});
    for (const AnimationInfo::Clip& c : info.animations)
      out["animations"].push_back({{"name", c.name}, {"start", c.start}, {"end", c.end}});
    return dumped(out);
  }
  Json out = {{"file", path},
              {"kind", "point_cache"},
              {"format", info.format},
              {"frames", info.frames},
              {"points", info.points}};
  if (info.seconds.empty()) {
    out["start"] = info.start;
    out["step"] = info.step;
  } else {
    out["seconds"] = info.seconds;
  }
  return dumped(out);
}

std::string infoJson(const std::string& path, const VolumeFileInfo& info) {
  Json out = {
      {"file", path}, {"kind", "volume"}, {"format", info.format}, {"grids", Json::array()}};
  for (const VolumeFileInfo::Grid& g : info.grids) {
    Json grid = {{"name", g.name}, {"type", g.type}, {"class", g.gridClass}};
    if (g.resolution != openvdb::Coord(0)) grid["resolution"] = json(g.resolution);
    if (g.activeVoxels) grid["active_voxels"] = *g.activeVoxels;
    if (g.voxelSize) grid["voxel_size"] = json(*g.voxelSize);
    if (g.worldBox) grid["world_box"] = {json(g.worldBox->min()), json(g.worldBox->max())};
    if (!g.files.empty()) grid["files"] = g.files;
    out["grids"].push_back(std::move(grid));
  }
  for (const auto& [key, value] : info.facts) out[key] = value;
  return dumped(out);
}

}  // namespace innermap
