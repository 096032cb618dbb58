// USD's text format (.usda) of volumes: Pixar, "UsdVol: Volume, OpenVDBAsset".
#include <fmt/format.h>

#include <cctype>
#include <filesystem>
#include <map>
#include <optional>
#include <ostream>
#include <set>

#include "core/file.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/io/vdb_file.h"

namespace innermap {
namespace {

// What stands at one time; without a frame, at all times.
struct Asset {
  std::optional<std::int64_t> frame;
  std::string path;  // as the file refers to it
};

struct Field {
  std::string name, type;
  std::vector<Asset> assets;
};

struct Scene {
  std::vector<Field> fields;
  std::vector<std::pair<std::optional<std::int64_t>, openvdb::BBoxd>> extents;
};

// A prim's name: letters, digits and _, no digit first, none of those taken.
std::string primName(const std::string& name, std::set<std::string>& taken) {
  std::string out;
  for (const char c : name)
    out += std::isalnum(static_cast<unsigned char>(c)) && static_cast<unsigned char>(c) < 128 ? c
                                                                                              : '_';
  if (out.empty() || std::isdigit(static_cast<unsigned char>(out[0]))) out = "_" + out;
  while (!taken.insert(out).second) out += "_";
  return out;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += static_cast<unsigned char>(c) < ' ' ? '_' : c;
  }
  return out + "\"";
}

// The path from the folder of `path` on.
std::string assetPath(const std::string& path, const std::string& file) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path folder = fs::absolute(path, error).parent_path();
  std::string relative = fs::absolute(file, error).lexically_relative(folder).generic_string();
  if (relative.empty()) relative = fs::absolute(file, error).generic_string();
  for (const char c : relative)
    if (c == '@' || static_cast<unsigned char>(c) < ' ')
      throw FileError(file, "has a name that USD files cannot refer to; rename it");
  return relative[0] == '.' || relative[0] == '/' ? relative : "./" + relative;
}

std::string typeName(const std::string& type) {
  static const std::map<std::string, std::string> names{
      {"float", "float"},   {"double", "double"}, {"int32", "int"},
      {"int64", "int64"},   {"bool", "bool"},     {"vec3s", "float3"},
      {"vec3d", "double3"}, {"vec3i", "int3"},    {"mask", "mask"}};
  const auto found = names.find(type.substr(0, type.find(' ')));
  return found == names.end() ? "" : found->second;
}

// The active box by outer faces, which the grid's statistics say.
void expand(openvdb::BBoxd& box, const openvdb::GridBase& grid) {
  const auto least =
      grid.getMetadata<openvdb::Vec3IMetadata>(openvdb::GridBase::META_FILE_BBOX_MIN);
  const auto most = grid.getMetadata<openvdb::Vec3IMetadata>(openvdb::GridBase::META_FILE_BBOX_MAX);
  if (!least || !most) return;
  for (int corner = 0; corner < 8; ++corner) {
    openvdb::Vec3d at;
    for (int a = 0; a < 3; ++a)
      at[a] = corner >> a & 1 ? most->value()[a] + 0.5 : least->value()[a] - 0.5;
    box.expand(grid.indexToWorld(at));
  }
}

Scene collect(const std::string& path, const std::vector<UsdFrame>& frames,
              const UsdVolumeSettings& settings) {
  Scene scene;
  const std::set<std::string> chosen(settings.names.begin(), settings.names.end());
  std::set<std::string> found;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    reportProgress("reading headers", static_cast<double>(i) / static_cast<double>(frames.size()));
    const VdbInfo info = readVdbInfo(frames[i].path);
    const std::string asset = assetPath(path, frames[i].path);
    openvdb::BBoxd box;
    for (const VdbGridInfo& grid : info.grids) {
      if (!chosen.empty() && !chosen.count(grid.name)) continue;
      if (grid.grid) expand(box, *grid.grid);
      auto field = scene.fields.begin();
      while (field != scene.fields.end() && field->name != grid.name) ++field;
      if (field == scene.fields.end())
        field = scene.fields.insert(field, {grid.name, typeName(grid.type), {}});
      field->assets.push_back({frames[i].number, asset});
      found.insert(grid.name);
    }
    if (!box.empty()) scene.extents.emplace_back(frames[i].number, box);
  }
  for (const std::string& name : chosen)
    if (!found.count(name))
      throw FileError(frames.front().path,
                      "has no grid '" + name + "'; `innermap info` lists them");
  if (scene.fields.empty()) throw FileError(frames.front().path, "has no grids to refer to");
  return scene;
}

std::string textOf(const openvdb::BBoxd& box) {
  const auto corner = [](const openvdb::Vec3d& p) {
    return fmt::format("({}, {}, {})", float(p.x()), float(p.y()), float(p.z()));
  };
  return fmt::format("[{}, {}]", corner(box.min()), corner(box.max()));
}

// "TYPE NAME = VALUE", or its samples by time.
template <class Samples, class Text>
std::string attribute(const std::string& indent, const std::string& name, const Samples& samples,
                      const Text& text) {
  const auto& [frame, first] = samples.front();
  if (!frame) return fmt::format("{}{} = {}\n", indent, name, text(first));
  std::string out = fmt::format("{}{}.timeSamples = {{\n", indent, name);
  for (const auto& [at, value] : samples)
    out += fmt::format("{}    {}: {},\n", indent, *at, text(value));
  return out + indent + "}\n";
}

std::string layerMetadata(const std::string& root, const std::vector<UsdFrame>& frames,
                          const UsdVolumeSettings& settings) {
  std::string text = fmt::format("#usda 1.0\n(\n    defaultPrim = \"{}\"\n", root);
  if (frames.front().number)
    text += fmt::format("    startTimeCode = {}\n    endTimeCode = {}\n", *frames.front().number,
                        *frames.back().number);
  return text + fmt::format(
                    "    metersPerUnit = {}\n    timeCodesPerSecond = {}\n"
                    "    upAxis = \"{}\"\n)\n\n",
                    settings.space.unitOfOutput(), settings.framesPerSecond,
                    settings.space.upOfOutput() == UpAxis::z ? "Z" : "Y");
}

// Of row vectors, as USD has them.
std::string transformOp(const Similarity& by) {
  if (by.isIdentity()) return "";
  const Mat3 m = by.matrix();
  std::string rows;
  for (int a = 0; a < 3; ++a)
    rows += fmt::format("({}, {}, {}, 0), ", m[0][a] + 0.0, m[1][a] + 0.0, m[2][a] + 0.0);
  return fmt::format(
      "    matrix4d xformOp:transform = ( {}(0, 0, 0, 1) )\n"
      "    uniform token[] xformOpOrder = [\"xformOp:transform\"]\n",
      rows);
}

// place: "/ROOT" or "/ROOT/NAME"; transform: lines of the prim.
std::string volumeText(const std::string& place, const Scene& scene, const std::string& transform) {
  std::string text = transform;
  if (!scene.extents.empty()) text += attribute("    ", "float3[] extent", scene.extents, textOf);
  std::set<std::string> taken;
  std::string prims;
  for (const Field& field : scene.fields) {
    const std::string name = primName(field.name, taken);
    text += fmt::format("    rel field:{} = <{}/{}>\n", name, place, name);
    prims += fmt::format("\n    def OpenVDBAsset \"{}\"\n    {{\n        token fieldName = {}\n",
                         name, quoted(field.name));
    if (!field.type.empty())
      prims += fmt::format("        token fieldDataType = \"{}\"\n", field.type);
    std::vector<std::pair<std::optional<std::int64_t>, std::string>> samples;
    for (const Asset& asset : field.assets) samples.emplace_back(asset.frame, asset.path);
    prims += attribute("        ", "asset filePath", samples,
                       [](const std::string& p) { return "@" + p + "@"; });
    prims += "    }\n";
  }
  return fmt::format("def Volume \"{}\"\n{{\n", place.substr(place.rfind('/') + 1)) + text + prims +
         "}\n";
}

std::string stemName(const std::string& path, std::set<std::string>& taken) {
  return primName(std::filesystem::path(path).stem().string(), taken);
}

std::string indented(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at) + 1;
    out += (end > at + 1 ? "    " : "") + text.substr(at, end - at);
    at = end;
  }
  return out;
}

}  // namespace

std::vector<Setting> describe(UsdVolumeSettings& s) {
  return {Setting("fps", "N", &s.framesPerSecond, "frames a second of a .usda file")
              .above(0, 1e6)
              .rare()};
}

void writeUsdVolume(const std::string& path, const std::vector<UsdFrame>& frames,
                    const UsdVolumeSettings& settings) {
  openvdb::initialize();
  requireDescribed(settings);
  if (frames.empty()) throw DataError("there are no .vdb files to refer to");
  std::set<std::string> roots;
  const std::string root = stemName(path, roots);
  const std::string transform = transformOp(inputToOutput(settings.space));
  std::string text = layerMetadata(root, frames, settings);
  if (frames.front().number || frames.size() == 1) {
    text += volumeText("/" + root, collect(path, frames, settings), transform);
  } else {
    text += fmt::format("def Xform \"{}\"\n{{\n", root) + transform;
    std::set<std::string> taken;
    for (const UsdFrame& file : frames)
      text += "\n" + indented(volumeText("/" + root + "/" + stemName(file.path, taken),
                                         collect(path, {file}, settings), ""));
    text += "}\n";
  }
  writeWholeFile(path, [&](std::ostream& stream) { stream << text; });
}

}  // namespace innermap
