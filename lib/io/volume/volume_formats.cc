// The one table of the formats that grids are written to.
#include "io/volume/detail/volume_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/io/volume_texture.h"
#include "io/volume/detail/volume_file_info.h"

namespace innermap {
namespace {

struct Entry {
  VolumeFormat format;
  VolumeWriter writer;
  VolumeReader reader = {};
  VolumeFileInfo (*info)(const std::string& path) = nullptr;  // null: `innermap info` has its own
};

Entry nifti(const char* ending) {
  return {{ending,
           "NIfTI",
           "a dense box of one grid, for medical programs",
           {"resolution", "pad", "cube", "power_of_two"}},
          {writeNifti, planNifti, niftiMemory},
          {readNifti, niftiNeed, {"background", "as_voxels"}},
          niftiInfo};
}

const std::vector<Entry>& table() {
  static const std::vector<Entry> entries{
      {{".exr",
        "EXR",
        "a dense box in pictures: an atlas of tiles, slices or parts",
        {"layout", "half", "channels", "resolution", "pad", "cube", "power_of_two", "axis",
         "active", "rows", "tiles"}},
       {writeExrVolume, planExrVolume, exrVolumeMemory},
       {readExrVolume,
        exrVolumeNeed,
        {"layout", "slices", "voxel_size", "axis", "background", "rows", "tiles"}}},
      {{".nvdb", "NanoVDB", "the sparse grids as they are, for GPUs", {"half", "zip"}},
       {writeNanoVdb, planNanoVdb, nanoVdbMemory},
       {},
       nanoVdbInfo},
      {{".vti",
        "VTK image data",
        "a dense box, an array a grid, for ParaView",
        {"resolution", "pad", "cube", "power_of_two"}},
       {writeVti, planVti, vtiMemory},
       {},
       vtiInfo},
      {{".dds",
        "DDS",
        "a dense box as a volume texture of one to four channels, as of EXR",
        {"half", "resolution", "pad", "cube", "power_of_two", "axis", "rows"}},
       {writeDds, planDds, ddsMemory},
       {},
       ddsInfo},
      nifti(".nii"),
      nifti(".nii.gz"),
      {{".usda",
        "USD",
        "a volume that refers to the .vdb file, or to a sequence of them",
        {},
        true},
       {},
       {},
       usdInfo},
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

// Throws SettingError for a setting that is not its default and that `heeded` does not name.
template <class Settings>
void requireHeeded(const Entry& entry, const std::vector<std::string>& heeded, Settings settings) {
  requireDescribed(settings);
  Settings plain;
  const std::vector<Setting> given = describe(settings), usual = describe(plain);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < given.size(); ++i)
    if (!sameValue(given[i].value, usual[i].value)) names.push_back(given[i].name);
  if (settings.rowsUp != plain.rowsUp) names.push_back("rows");
  if (settings.tiles) names.push_back("tiles");
  for (const std::string& name : names)
    if (std::find(heeded.begin(), heeded.end(), name) == heeded.end())
      throw SettingError(
          name, fmt::format("has no meaning for {} files; leave it out", entry.format.ending));
}

const Entry& checked(const std::string& path, const VolumeTextureSettings& settings) {
  const Entry& entry = entryOf(path);
  if (entry.format.refers)
    throw FileError(path,
                    "would refer to .vdb files, not hold grids; write those, then "
                    "`innermap export` of them");
  requireHeeded(entry, entry.format.settings, settings);
  return entry;
}

const Entry& checked(const std::string& path, const VolumeTextureReadSettings& settings) {
  const Entry& entry = entryOf(path);
  if (!entry.reader.read)
    throw FileError(path, fmt::format("is a {} file, which innermap writes but does not read; "
                                      "import the file that it was made of",
                                      entry.format.name));
  requireHeeded(entry, entry.reader.settings, settings);
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

VolumeFileInfo readVolumeFileInfo(const std::string& path) {
  const Entry& entry = entryOf(path);
  if (!entry.info) throw FileError(path, "has an ending of none of these formats");
  VolumeFileInfo info = entry.info(path);
  info.format = entry.format.name;
  return info;
}

VolumeTextureNeed volumeTextureReadNeed(const std::string& path,
                                        const VolumeTextureReadSettings& settings) {
  return checked(path, settings).reader.need(path, settings);
}

VolumeTextureContents readVolumeTexture(const std::string& path,
                                        const VolumeTextureReadSettings& settings) {
  const Entry& entry = checked(path, settings);
  VolumeTextureContents contents = entry.reader.read(path, settings);
  contents.format = entry.format.name;
  return contents;
}

}  // namespace innermap
