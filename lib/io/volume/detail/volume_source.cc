#include "io/volume/detail/volume_source.h"

#include <OpenEXR/ImfChannelList.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/io/pictures.h"
#include "io/volume/detail/volume_builder.h"

namespace innermap {
namespace {

constexpr int kMostSlices = 65536;
constexpr int kFarthest = 1 << 30;  // index coordinates

VolumeLayout layoutOf(const std::string& path, const std::string& attribute) {
  try {
    return parseVolumeLayout("attribute 'volumeLayout'", attribute);
  } catch (const SettingError& error) {
    throw FileError(path, error.what());
  }
}

// #### or %04d in the last component.
bool isPattern(const std::string& path) {
  const std::string name = std::filesystem::path(path).filename().string();
  if (name.find('#') != std::string::npos) return true;
  for (std::size_t at = name.find('%'); at != std::string::npos; at = name.find('%', at + 1)) {
    const std::size_t end = name.find_first_not_of("0123456789", at + 1);
    if (end != std::string::npos && name[end] == 'd') return true;
  }
  return false;
}

// The pattern of the files beside one, which differ from it in the last number of the name.
std::optional<FramePattern> patternBeside(const std::string& path) {
  const std::size_t begin =
      path.find_last_of('/') == std::string::npos ? 0 : path.find_last_of('/') + 1;
  std::size_t end = path.find_last_of('.');
  if (end == std::string::npos || end < begin) end = path.size();
  const auto digit = [&](std::size_t i) {
    return std::isdigit(static_cast<unsigned char>(path[i])) != 0;
  };
  while (end > begin && !digit(end - 1)) --end;
  std::size_t from = end;
  while (from > begin && digit(from - 1)) --from;
  if (from == end) return std::nullopt;
  return FramePattern("input",
                      path.substr(0, from) + std::string(end - from, '#') + path.substr(end));
}

}  // namespace

VolumeSource::VolumeSource(const std::string& path, const VolumeTextureReadSettings& settings)
    : settings_(settings) {
  openFirst(path);
  const VolumeAttributes attributes = readVolumeAttributes(reader_->path(), reader_->header(0));
  fixLayout(attributes);
  if (layout_ == VolumeLayout::slices) findFiles(path, attributes);
  fixTiles(attributes);
  fixPlace(attributes);
  fixGrids(attributes);
  reader_->check(0, channels_);
}

void VolumeSource::openFirst(const std::string& path) {
  patternGiven_ = isPattern(path);
  if (!patternGiven_) {
    reader_ = std::make_unique<ExrReader>(path);
    return;
  }
  const FrameList list = findFrames({path}, {".exr"});
  if (list.frames.empty()) throw FileError(path, "no file has that name; give another pattern");
  files_.emplace("input", path);
  const std::int64_t first = list.frames.front().number;
  if (first < 0 || first > kFarthest)
    throw FileError(list.frames.front().path, "has a number that no slice can have");
  firstFile_ = static_cast<int>(first);
  reader_ = std::make_unique<ExrReader>(files_->path(firstFile_));
}

void VolumeSource::fixLayout(const VolumeAttributes& a) {
  if (settings_.layout)
    layout_ = *settings_.layout;
  else if (a.layout)
    layout_ = layoutOf(reader_->path(), *a.layout);
  else if (patternGiven_)
    layout_ = VolumeLayout::slices;
  else
    layout_ = reader_->parts() > 1 ? VolumeLayout::parts : VolumeLayout::atlas;
  if (patternGiven_ && layout_ != VolumeLayout::slices)
    throw FileError(reader_->path(), fmt::format("is of the layout {}, not a file of slices; give "
                                                 "its own path",
                                                 volumeLayoutName(layout_)));
  if (layout_ != VolumeLayout::parts && reader_->parts() != 1)
    throw FileError(reader_->path(),
                    fmt::format("has {} parts, where {} have one; give --layout parts",
                                reader_->parts(), volumeLayoutName(layout_)));
}

void VolumeSource::findFiles(const std::string& path, const VolumeAttributes& a) {
  if (patternGiven_) {
    if (a.sliceIndex && *a.sliceIndex != 0)
      throw FileError(reader_->path(),
                      fmt::format("is slice {}, and no file has the first one", *a.sliceIndex));
    return;
  }
  files_ = patternBeside(path);
  if (!files_) throw FileError(path, "has no number in its name, which slices have");
  const std::int64_t number = frameNumber(path).value_or(0);
  const std::int64_t first = number - a.sliceIndex.value_or(0);
  if (first < 0 || first > kFarthest || (a.sliceIndex && *a.sliceIndex < 0))
    throw FileError(path, fmt::format("attribute 'volumeSliceIndex' does not fit the number {} in "
                                      "its name",
                                      number));
  firstFile_ = static_cast<int>(first);
  if (first != number) reader_ = std::make_unique<ExrReader>(files_->path(first));
}

int VolumeSource::countFiles() const {
  int count = 0;
  std::error_code ignored;
  while (count < kMostSlices &&
         std::filesystem::exists(files_->path(std::int64_t(firstFile_) + count), ignored))
    ++count;
  return count;
}

int VolumeSource::fixCount(const VolumeAttributes& a) const {
  const int places = layout_ == VolumeLayout::atlas   ? lattice_.tileColumns * lattice_.tileRows
                     : layout_ == VolumeLayout::parts ? reader_->parts()
                                                      : countFiles();
  const int count = settings_.slices.value_or(a.sliceCount.value_or(places));
  const char* what = settings_.slices ? "--slices" : "attribute 'volumeSliceCount'";
  if (count < 1 || count > places)
    throw FileError(reader_->path(),
                    fmt::format("{} is {}, but there are {} {}", what, count, places,
                                layout_ == VolumeLayout::atlas   ? "tiles"
                                : layout_ == VolumeLayout::parts ? "parts"
                                                                 : "files numbered in a row"));
  if (count > kMostSlices)
    throw FileError(reader_->path(),
                    fmt::format("has {} slices; at most {} are read", count, kMostSlices));
  return count;
}

void VolumeSource::fixTiles(const VolumeAttributes& a) {
  const std::string& path = reader_->path();
  lattice_.setAxis(settings_.axis.value_or(a.axis.value_or(2)));
  lattice_.rowsUp = settings_.rowsUp.value_or(a.rowsUp.value_or(false));
  const int width = reader_->width(0), height = reader_->height(0);
  if (layout_ == VolumeLayout::atlas) {
    if (!settings_.tiles && !a.tiles)
      throw FileError(path,
                      "has no attribute 'volumeTiles'; give --tiles COLUMNSxROWS (or, for "
                      "slices, a pattern such as name.####.exr)");
    if (settings_.tiles)
      std::tie(lattice_.tileColumns, lattice_.tileRows) = *settings_.tiles;
    else
      lattice_.tileColumns = a.tiles->x(), lattice_.tileRows = a.tiles->y();
    const int c = lattice_.tileColumns, r = lattice_.tileRows;
    if (c < 1 || r < 1 || c > width || r > height || width % c != 0 || height % r != 0 ||
        std::int64_t(c) * r > std::numeric_limits<int>::max())
      throw FileError(path, fmt::format("{} {}x{} do not fit its {} x {} pixels",
                                        settings_.tiles ? "--tiles" : "attribute 'volumeTiles':", c,
                                        r, width, height));
  }
  openvdb::Coord& size = lattice_.size;
  size[lattice_.columnAxis] = width / lattice_.tileColumns;
  size[lattice_.rowAxis] = height / lattice_.tileRows;
  if (lattice_.width() > kMostSlices || lattice_.height() > kMostSlices)
    throw FileError(path, fmt::format("its slices have {} x {} pixels; at most {} are read along "
                                      "a side",
                                      lattice_.width(), lattice_.height(), kMostSlices));
  if (a.tileSize && *a.tileSize != openvdb::Vec2i(lattice_.width(), lattice_.height()))
    throw FileError(
        path, fmt::format("attribute 'volumeTileSize' says {} x {}, but slices have {} "
                          "x {} pixels",
                          a.tileSize->x(), a.tileSize->y(), lattice_.width(), lattice_.height()));
  size[lattice_.axis] = fixCount(a);
  if (a.resolution && *a.resolution != size)
    throw FileError(path, fmt::format("attribute 'volumeResolution' says {} x {} x {} voxels, but "
                                      "the slices hold {} x {} x {}",
                                      a.resolution->x(), a.resolution->y(), a.resolution->z(),
                                      size.x(), size.y(), size.z()));
}

void VolumeSource::fixPlace(const VolumeAttributes& a) {
  const std::string& path = reader_->path();
  if (settings_.voxelSize) {
    const double voxel = *settings_.voxelSize;
    const Vec3& low = settings_.lowerCorner;
    if (!(voxel > 0) || !std::isfinite(voxel))
      throw SettingError("--voxel-size", "must be a positive length");
    lattice_.indexToWorld.setToScale(openvdb::Vec3d(voxel));
    lattice_.indexToWorld.postTranslate(openvdb::Vec3d(low.x, low.y, low.z) +
                                        openvdb::Vec3d(0.5 * voxel));
  } else {
    if (!a.indexToWorld)
      throw FileError(path,
                      "has no attribute 'indexToWorld'; give --voxel-size (and "
                      "--lower-corner)");
    lattice_.indexToWorld = *a.indexToWorld;
    if (a.indexMin) lattice_.origin = *a.indexMin;
    for (int i = 0; i < 3; ++i)
      if (std::abs(std::int64_t(lattice_.origin[i])) > kFarthest)
        throw FileError(path, "attribute 'volumeIndexMin' is beyond what grids hold");
    if (a.indexMax && *a.indexMax != lattice_.box().max())
      throw FileError(path,
                      "attributes 'volumeIndexMin' and 'volumeIndexMax' do not fit the "
                      "slices");
  }
  const openvdb::Mat4d& m = lattice_.indexToWorld;
  const bool affine =
      std::abs(m(0, 3)) + std::abs(m(1, 3)) + std::abs(m(2, 3)) == 0 && m(3, 3) == 1;
  try {
    if (!affine) throw openvdb::ArithmeticError("not affine");
    openvdb::math::Transform::createLinearTransform(m);
  } catch (const openvdb::Exception&) {
    if (settings_.voxelSize)
      throw SettingError("--voxel-size", "OpenVDB cannot hold voxels of that size");
    throw FileError(path,
                    "attribute 'indexToWorld' is no invertible affine matrix; give "
                    "--voxel-size instead");
  }
}

void VolumeSource::fixGrids(const VolumeAttributes& a) {
  const std::string& path = reader_->path();
  grids_ = a.grids;
  if (grids_.empty()) {
    grids_ = gridsOfChannels(path, reader_->header(0), settings_.names);
  } else if (!settings_.names.empty()) {
    std::vector<std::string> there;
    for (const VolumeGrid& grid : a.grids) there.push_back(grid.name);
    grids_.clear();
    for (const std::string& name : settings_.names) {
      const auto found = std::find(there.begin(), there.end(), name);
      if (found == there.end())
        throw FileError(path,
                        fmt::format("has no grid '{}'; it has {}", name, fmt::join(there, ", ")));
      grids_.push_back(a.grids[static_cast<std::size_t>(found - there.begin())]);
    }
  }
  std::set<std::string> seen;
  for (VolumeGrid& grid : grids_) {
    if (!seen.insert(grid.name).second)
      throw FileError(path, fmt::format("two grids are named '{}'", grid.name));
    if (!isVolumeType(grid.type))
      throw FileError(path, fmt::format("grid '{}' has the type '{}', which cannot be read",
                                        grid.name, grid.type));
    if (isVectorType(grid.type) != grid.isVector())
      throw FileError(path, fmt::format("grid '{}' of type {} has {} channels", grid.name,
                                        grid.type, grid.channels.size()));
    if (settings_.background) grid.background = openvdb::Vec3d(*settings_.background);
    if (settings_.gridClass) grid.gridClass = *settings_.gridClass;
    for (int c = 0; c < 3; ++c)
      if (!std::isfinite(grid.background[c]))
        throw FileError(path, fmt::format("the background of grid '{}' is not finite; give "
                                          "--background",
                                          grid.name));
    channels_.insert(channels_.end(), grid.channels.begin(), grid.channels.end());
    if (!grid.activeChannel.empty()) channels_.push_back(grid.activeChannel);
  }
}

bool VolumeSource::half(const VolumeGrid& grid) const {
  return reader_->header(0).channels().findChannel(grid.channels[0])->type == Imf::HALF;
}

std::uint64_t VolumeSource::memory() const {
  const std::uint64_t row = layout_ == VolumeLayout::atlas
                                ? std::uint64_t(reader_->width(0)) *
                                      std::uint64_t(lattice_.height()) * channels_.size() * 4
                                : 0;
  return reader_->memory(0) + row;
}

void VolumeSource::checkSlice(int slice, int part) const {
  const std::string& path = reader_->path();
  const auto fail = [&](const std::string& what) {
    throw FileError(path,
                    layout_ == VolumeLayout::parts ? fmt::format("part {}: {}", part, what) : what);
  };
  if (reader_->width(part) != lattice_.width() || reader_->height(part) != lattice_.height())
    fail(fmt::format("has {} x {} pixels where the first slice has {} x {}", reader_->width(part),
                     reader_->height(part), lattice_.width(), lattice_.height()));
  const VolumeAttributes a = readVolumeAttributes(path, reader_->header(part));
  if (a.sliceIndex && *a.sliceIndex != slice)
    fail(fmt::format("attribute 'volumeSliceIndex' is {} where slice {} should be", *a.sliceIndex,
                     slice));
  if (a.sliceCount && !settings_.slices && *a.sliceCount != lattice_.slices())
    fail(fmt::format("is of {} slices, not {}: it belongs to another volume", *a.sliceCount,
                     lattice_.slices()));
  reader_->check(part, channels_);
  if (reader_->memory(part) > 4 * reader_->memory(0))
    fail("is stored in larger tiles than the first slice");
}

void VolumeSource::read(int slice, const std::vector<float*>& outputs) {
  throwIfCancelled();
  if (layout_ == VolumeLayout::atlas) return readTile(slice, outputs);
  if (layout_ == VolumeLayout::slices && slice > 0)
    reader_ = std::make_unique<ExrReader>(files_->path(std::int64_t(firstFile_) + slice));
  const int part = layout_ == VolumeLayout::parts ? slice : 0;
  checkSlice(slice, part);
  reader_->read(part, 0, lattice_.height(), channels_, outputs);
}

void VolumeSource::readTile(int slice, const std::vector<float*>& outputs) {
  const auto stride = static_cast<std::size_t>(reader_->width(0));
  const auto width = static_cast<std::size_t>(lattice_.width());
  const auto height = static_cast<std::size_t>(lattice_.height());
  const int row = slice / lattice_.tileColumns;
  if (row != tileRowAt_) {
    tileRow_.resize(channels_.size());
    std::vector<float*> all;
    for (std::vector<float>& channel : tileRow_) {
      channel.resize(stride * height);
      all.push_back(channel.data());
    }
    reader_->read(0, row * lattice_.height(), lattice_.height(), channels_, all);
    tileRowAt_ = row;
  }
  const std::size_t left = static_cast<std::size_t>(slice % lattice_.tileColumns) * width;
  for (std::size_t c = 0; c < channels_.size(); ++c)
    for (std::size_t y = 0; y < height; ++y)
      std::copy_n(tileRow_[c].data() + y * stride + left, width, outputs[c] + y * width);
}

}  // namespace innermap
