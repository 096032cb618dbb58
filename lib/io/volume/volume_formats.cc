// The one table of the formats that grids are written to.
#include "io/volume/detail/volume_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/io/volume_texture.h"

namespace innermap {
namespace {

struct Entry {
  VolumeFormat format;
  VolumeWriter writer;
};

const std::vector<Entry>& table() {
  static const std::vector<Entry> entries{
      {{".exr",
        "EXR",
        "a dense box in pictures: an atlas of tiles, slices or parts",
        {"layout", "half", "channels", "resolution", "pad", "cube", "power_of_two", "axis",
         "active", "rows", "tiles"}},
       {writeExrVolume, planExrVolume, exrVolumeMemory}},
      {{".nvdb", "NanoVDB", "the sparse grids as they are, for GPUs", {"half", "zip"}},
       {writeNanoVdb, planNanoVdb, nanoVdbMemory}},
      {{".vti",
        "VTK image data",
        "a dense box, an array a grid, for ParaView",
        {"resolution", "pad", "cube", "power_of_two"}},
       {writeVti, planVti, vtiMemory}},
      {{".dds",
        "DDS",
        "a dense box as a volume texture of one to four channels, as of EXR",
        {"half", "resolution", "pad", "cube", "power_of_two", "axis", "rows"}},
       {writeDds, planDds, ddsMemory}},
  };
  return entries;
}

bool endsIn(const std::string& path, const std::string& ending) {
  return path.size() > ending.size() &&
         equalsIgnoringCase(path.substr(path.size() - ending.size()), ending);
}

const Entry& entryOf(const std::string& path) {
  for (const Entry& entry : table())
    if (endsIn(path, entry.format.ending)) return entry;
  return table().front();
}

bool sameValue(const SettingValue& a, const SettingValue& b) {
  return std::visit(
      [&](const auto& x) {
        const auto& y = std::get<std::decay_t<decltype(x)>>(b);
        if constexpr (std::is_same_v<std::decay_t<decltype(x)>, SettingChoice>)
          return x.now() == y.now();
        else
          return *x == *y;
      },
      a);
}

// Settings that the format does not heed, and that are not their defaults.
std::vector<std::string> unheeded(const VolumeFormat& format, VolumeTextureSettings settings) {
  VolumeTextureSettings plain;
  const std::vector<Setting> given = describe(settings), usual = describe(plain);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < given.size(); ++i)
    if (!sameValue(given[i].value, usual[i].value)) names.push_back(given[i].name);
  if (settings.rowsUp) names.push_back("rows");
  if (settings.tiles) names.push_back("tiles");
  const auto heeds = [&](const std::string& name) {
    return std::find(format.settings.begin(), format.settings.end(), name) != format.settings.end();
  };
  names.erase(std::remove_if(names.begin(), names.end(), heeds), names.end());
  return names;
}

const Entry& checked(const std::string& path, const VolumeTextureSettings& settings) {
  requireDescribed(settings);
  const Entry& entry = entryOf(path);
  for (const std::string& name : unheeded(entry.format, settings))
    throw SettingError(
        name, fmt::format("has no meaning for {} files; leave it out", entry.format.ending));
  return entry;
}

}  // namespace

const std::vector<VolumeFormat>& volumeFormats() {
  static const std::vector<VolumeFormat> formats = [] {
    std::vector<VolumeFormat> all;
    for (const Entry& entry : table()) all.push_back(entry.format);
    return all;
  }();
  return formats;
}

const VolumeFormat& volumeFormatOf(const std::string& path) {
  return volumeFormats()[static_cast<std::size_t>(&entryOf(path) - table().data())];
}

std::uint64_t volumeTextureMemory(const std::string& path, const openvdb::GridPtrVec& grids,
                                  const VolumeTextureSettings& settings) {
  return checked(path, settings).writer.memory(grids, settings);
}

VolumeTextureResult planVolumeTexture(const std::string& path, const openvdb::GridPtrVec& grids,
                                      const VolumeTextureSettings& settings) {
  const Entry& entry = checked(path, settings);
  VolumeTextureResult result = entry.writer.plan(path, grids, settings);
  result.format = entry.format.name;
  return result;
}

VolumeTextureResult writeVolumeTexture(const std::string& path, const openvdb::GridPtrVec& grids,
                                       const VolumeTextureSettings& settings) {
  const Entry& entry = checked(path, settings);
  requireMemory("writing " + path, entry.writer.memory(grids, settings),
                "export fewer grids or at a lower resolution");
  VolumeTextureResult result = entry.writer.write(path, grids, settings);
  result.format = entry.format.name;
  return result;
}

}  // namespace innermap
