// Grids of NIfTI files.
#include <fmt/format.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/Prune.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <limits>

#include "core/byte_order.h"
#include "core/file_bytes.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "io/nifti/detail/gzip.h"
#include "io/nifti/detail/nifti_header.h"
#include "io/volume/detail/volume_file_info.h"
#include "io/volume/detail/volume_formats.h"

namespace innermap {
namespace {

template <class T>
double real(const char* at, bool swapped) {
  return static_cast<double>(numberAt<T>(at, swapped));
}

template <class T>
std::int64_t whole(const char* at, bool swapped) {
  const T value = numberAt<T>(at, swapped);
  if constexpr (std::is_same_v<T, std::uint64_t>)
    return static_cast<std::int64_t>(
        std::min<T>(value, static_cast<T>(std::numeric_limits<std::int64_t>::max())));
  return static_cast<std::int64_t>(value);
}

struct ValueType {
  std::int64_t code;
  std::size_t bytes;
  double (*real)(const char* at, bool swapped);
  std::int64_t (*whole)(const char* at, bool swapped);  // null: no whole numbers
  bool wide = false;                                    // beyond what an int32 or a float holds
};

constexpr ValueType kTypes[] = {{2, 1, real<std::uint8_t>, whole<std::uint8_t>},
                                {4, 2, real<std::int16_t>, whole<std::int16_t>},
                                {8, 4, real<std::int32_t>, whole<std::int32_t>},
                                {16, 4, real<float>, nullptr},
                                {64, 8, real<double>, nullptr, true},
                                {256, 1, real<std::int8_t>, whole<std::int8_t>},
                                {512, 2, real<std::uint16_t>, whole<std::uint16_t>},
                                {768, 4, real<std::uint32_t>, whole<std::uint32_t>, true},
                                {1024, 8, real<std::int64_t>, whole<std::int64_t>, true},
                                {1280, 8, real<std::uint64_t>, whole<std::uint64_t>, true}};

const ValueType& typeOf(const std::string& path, std::int64_t code) {
  for (const ValueType& type : kTypes)
    if (type.code == code) return type;
  throw FileError(path, fmt::format("has values of NIfTI's type {}, which are no real numbers; "
                                    "convert it to whole numbers or floats",
                                    code));
}

// A file whose counts were compared with its size.
struct NiftiFile {
  std::string path, bytes;
  bool packed = false;
  NiftiHeader header;
  const ValueType* type = nullptr;
  int components = 1;
  std::uint64_t voxels = 0;
  bool scaled = false;
  openvdb::Mat4d place;

  std::uint64_t valueBytes() const {
    return voxels * static_cast<std::uint64_t>(components) * type->bytes;
  }
  std::uint64_t end() const { return static_cast<std::uint64_t>(header.offset) + valueBytes(); }
  openvdb::Coord size() const {
    return {int(header.dim[1]), int(header.dim[2]), int(header.dim[3])};
  }
  bool labels() const { return type->whole && !scaled && components == 1; }

  // The file's bytes, unpacked, a slab of voxels, and the grid when all voxels are active.
  std::uint64_t memory() const {
    std::uint64_t leaves = 1, slab = 1;
    for (int a = 0; a < 3; ++a) leaves *= static_cast<std::uint64_t>(size()[a]) / 8 + 1;
    for (int a = 0; a < 2; ++a) slab *= static_cast<std::uint64_t>(size()[a]);
    const std::uint64_t value = components == 3 ? 12 : type->wide ? 8 : 4;
    return bytes.size() + (packed ? end() : 0) + 8 * slab * value + leaves * (512 * value + 128);
  }
};

void shape(NiftiFile& file) {
  const auto& dim = file.header.dim;
  if (dim[4] > 1)
    throw FileError(file.path, fmt::format("holds {} volumes one after the other; split it into "
                                           "files of one each",
                                           dim[4]));
  if ((dim[5] != 1 && dim[5] != 3) || dim[6] > 1 || dim[7] > 1)
    throw FileError(file.path,
                    fmt::format("has {} x {} x {} values a voxel; files with one, or the "
                                "three of a vector, can be read",
                                dim[5], dim[6], dim[7]));
  file.components = static_cast<int>(dim[5]);
  const std::uint64_t held = file.packed ? mostUnpacked(file.bytes.size()) : file.bytes.size();
  const std::uint64_t value = file.type->bytes * static_cast<std::uint64_t>(file.components);
  std::uint64_t most = held / value;
  file.voxels = 1;
  for (std::size_t a = 1; a <= 3; ++a) {
    const auto count = static_cast<std::uint64_t>(dim[a]);
    if (count > most)
      throw FileError(file.path, "is cut short or says more than is there; export it again");
    most /= count;
    file.voxels *= count;
  }
  if (file.header.offset > (std::int64_t(1) << 40) || file.end() > held)
    throw FileError(file.path, "is cut short or says more than is there; export it again");
}

NiftiFile open(const std::string& path, const VolumeTextureReadSettings& settings) {
  NiftiFile file;
  file.path = path;
  file.bytes = readFileBytes(path, "a NIfTI file").bytes;
  file.packed = isGzip(file.bytes);
  constexpr std::size_t kStart = kNifti2Header + 4;
  file.header = parseNiftiHeader(
      path, file.packed ? unpacked(path, file.bytes, kStart) : file.bytes.substr(0, kStart));
  file.type = &typeOf(path, file.header.datatype);
  shape(file);
  const double slope = file.header.slope, inter = file.header.inter;
  file.scaled =
      std::isfinite(slope) && std::isfinite(inter) && slope != 0 && !(slope == 1 && inter == 0);
  file.place = settings.asVoxels ? file.header.asVoxels(path) : file.header.indexToWorld(path);
  return file;
}

// "scan" of "a/scan.nii.gz".
std::string stem(const std::string& path) {
  const std::string name = std::filesystem::path(path).filename().string();
  return name.substr(0, std::min(name.find('.'), name.size()));
}

std::string nameOf(const NiftiFile& file, const VolumeTextureReadSettings& settings) {
  if (settings.names.size() > 1)
    throw SettingError("grids", "a NIfTI file holds one grid; give one name");
  if (!settings.names.empty()) return settings.names.front();
  std::string name = file.header.intentName.empty() ? stem(file.path) : file.header.intentName;
  for (char& c : name)
    if (c <= ' ' || c > '~') c = '_';
  return name.empty() ? "scan" : name;
}

// A grid of the file's values; `value(i)` is that of voxel i in the file's order.
template <class Grid, class Value>
typename Grid::Ptr build(const NiftiFile& file, typename Grid::ValueType background,
                         const Value& value) {
  using Number = typename Grid::ValueType;
  const auto grid = Grid::create(background);
  const openvdb::Coord size = file.size();
  const std::uint64_t layer = std::uint64_t(size.x()) * std::uint64_t(size.y());
  std::vector<Number> slab;
  for (int z = 0; z < size.z(); z += 8) {
    reportProgress("reading the NIfTI file", static_cast<double>(z) / size.z());
    const int end = std::min(z + 8, size.z());
    const std::uint64_t first = layer * std::uint64_t(z);
    slab.resize(layer * std::uint64_t(end - z));
    parallelBlocks(slab.size(), 65536, [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i) slab[i] = value(first + i);
    });
    const openvdb::tools::Dense<Number, openvdb::tools::LayoutXYZ> dense(
        openvdb::CoordBBox({0, 0, z}, {size.x() - 1, size.y() - 1, end - 1}), slab.data());
    openvdb::tools::copyFromDense(dense, *grid, openvdb::zeroVal<Number>());
  }
  reportProgress("reading the NIfTI file", 1);
  return grid;
}

struct Numbers {
  const NiftiFile& file;
  const char* values;
  std::atomic<std::size_t>& notFinite;

  double operator()(std::uint64_t i) const {
    const double value = file.type->real(values + i * file.type->bytes, file.header.swapped);
    if (!std::isfinite(value)) ++notFinite;
    return file.scaled ? value * file.header.slope + file.header.inter : value;
  }
};

openvdb::GridBase::Ptr gridOf(const NiftiFile& file, const char* values, double background,
                              std::atomic<std::size_t>& notFinite) {
  const ValueType& type = *file.type;
  const Numbers number{file, values, notFinite};
  if (file.components == 3)
    return build<openvdb::Vec3SGrid>(file, openvdb::Vec3s(float(background)), [&](std::uint64_t i) {
      return openvdb::Vec3s(float(number(i)), float(number(i + file.voxels)),
                            float(number(i + 2 * file.voxels)));
    });
  const auto label = [&](std::uint64_t i) {
    return type.whole(values + i * type.bytes, file.header.swapped);
  };
  if (file.labels() && type.wide)
    return build<openvdb::Int64Grid>(file, std::llround(background), label);
  if (file.labels())
    return build<openvdb::Int32Grid>(file,
                                     static_cast<std::int32_t>(std::clamp(background, -2e9, 2e9)),
                                     [&](auto i) { return static_cast<std::int32_t>(label(i)); });
  if (type.wide && !type.whole) return build<openvdb::DoubleGrid>(file, background, number);
  return build<openvdb::FloatGrid>(file, float(background),
                                   [&](auto i) { return static_cast<float>(number(i)); });
}

}  // namespace

VolumeTextureNeed niftiNeed(const std::string& path, const VolumeTextureReadSettings& settings) {
  const NiftiFile file = open(path, settings);
  return {file.size(), file.memory()};
}

VolumeFileInfo niftiInfo(const std::string& path) {
  VolumeTextureReadSettings settings;
  const auto told = [&] {
    try {
      return open(path, settings);
    } catch (const FileError&) {  // it may lack orientation alone
      settings.asVoxels = true;
      return open(path, settings);
    }
  };
  const NiftiFile file = told();
  VolumeFileInfo::Grid grid;
  grid.name = nameOf(file, {});
  grid.type = file.components == 3                   ? "vec3s"
              : file.labels()                        ? (file.type->wide ? "int64" : "int32")
              : file.type->wide && !file.type->whole ? "double"
                                                     : "float";
  grid.resolution = file.size();
  openvdb::Vec3d voxel;
  for (int a = 0; a < 3; ++a) {
    const openvdb::Vec4d row = file.place.row(a);
    voxel[a] = openvdb::Vec3d(row[0], row[1], row[2]).length();
  }
  grid.voxelSize = voxel;
  grid.worldBox = boxOf(file.place, grid.resolution);
  VolumeFileInfo info;
  info.grids.push_back(grid);
  info.facts.emplace_back("place by", settings.asVoxels       ? "voxels: the file says none"
                                      : file.header.sform > 0 ? "sform"
                                                              : "qform");
  return info;
}

VolumeTextureContents readNifti(const std::string& path,
                                const VolumeTextureReadSettings& settings) {
  openvdb::initialize();
  NiftiFile file = open(path, settings);
  const std::string name = nameOf(file, settings);
  requireMemory("reading " + path, file.memory() - file.bytes.size(),
                "use a smaller file or raise --max-memory");
  if (file.packed) file.bytes = unpacked(path, file.bytes, file.end());
  if (file.bytes.size() < file.end())
    throw FileError(path, "is cut short or says more than is there; export it again");
  std::atomic<std::size_t> notFinite{0};
  const openvdb::GridBase::Ptr grid = gridOf(file, file.bytes.data() + file.header.offset,
                                             settings.background.value_or(0), notFinite);
  grid->setName(name);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(file.place));
  if (settings.gridClass)
    grid->setGridClass(openvdb::GridBase::stringToGridClass(*settings.gridClass));
  VolumeTextureContents contents;
  contents.grids = {grid};
  contents.resolution = file.size();
  contents.notFinite = notFinite;
  return contents;
}

}  // namespace innermap
