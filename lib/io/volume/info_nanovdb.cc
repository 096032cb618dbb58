// What NanoVDB files say of their grids, from the segments' headers: nanovdb/util/IO.h.

#include <cstring>

#include "core/file_bytes.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "io/volume/detail/volume_file_info.h"

#define NANOVDB_USE_ZIP
#include <nanovdb/util/IO.h>

namespace innermap {
namespace {

// Their enumerations are no larger than these; NanoVDB's own texts of others end the process.
const char* typeName(nanovdb::GridType type) {
  using nanovdb::GridType;
  switch (type) {
    case GridType::Float:
      return "float";
    case GridType::Double:
      return "double";
    case GridType::Int32:
      return "int32";
    case GridType::Int64:
      return "int64";
    case GridType::Vec3f:
      return "vec3s";
    case GridType::Vec3d:
      return "vec3d";
    case GridType::Mask:
      return "mask";
    case GridType::Boolean:
      return "bool";
    case GridType::Fp16:
      return "float (16 bits)";
    case GridType::Fp8:
      return "float (8 bits)";
    default:
      return "another type";
  }
}

const char* className(nanovdb::GridClass kind) {
  using nanovdb::GridClass;
  switch (kind) {
    case GridClass::LevelSet:
      return "level set";
    case GridClass::FogVolume:
      return "fog volume";
    case GridClass::Staggered:
      return "staggered";
    default:
      return "";
  }
}

VolumeFileInfo::Grid gridOf(const nanovdb::io::MetaData& data, std::string name) {
  VolumeFileInfo::Grid grid;
  grid.name = std::move(name);
  grid.type = typeName(data.gridType);
  grid.gridClass = className(data.gridClass);
  grid.activeVoxels = data.voxelCount;
  openvdb::Vec3d voxel;
  openvdb::BBoxd box;
  for (int a = 0; a < 3; ++a) {
    voxel[a] = data.voxelSize[a];
    const std::int64_t side =
        std::int64_t(data.indexBBox.max()[a]) - std::int64_t(data.indexBBox.min()[a]) + 1;
    grid.resolution[a] = data.voxelCount > 0 && side > 0 && side < (std::int64_t(1) << 31)
                             ? static_cast<int>(side)
                             : 0;
    box.min()[a] = data.worldBBox.min()[a];
    box.max()[a] = data.worldBBox.max()[a];
  }
  grid.voxelSize = voxel;
  if (data.voxelCount > 0) grid.worldBox = box;
  return grid;
}

}  // namespace

VolumeFileInfo nanoVdbInfo(const std::string& path) {
  const OpenFile file(path, "a NanoVDB file");
  VolumeFileInfo info;
  std::uint64_t at = 0;
  const auto read = [&](void* to, std::size_t count) {
    if (count > file.size() - at) throw FileError(path, "is cut short; export it again");
    file.read(at, static_cast<char*>(to), count);
    at += count;
  };
  while (at < file.size()) {
    throwIfCancelled();
    nanovdb::io::Header header;
    read(&header, sizeof(header));
    if (header.magic != NANOVDB_MAGIC_NUMBER) throw FileError(path, "is no NanoVDB file");
    std::uint64_t values = 0;
    for (int i = 0; i < header.gridCount; ++i) {
      nanovdb::io::MetaData data;
      read(&data, sizeof(data));
      if (data.nameSize > file.size() - at || data.fileSize > file.size())
        throw FileError(path, "says more than is there: damaged; export it again");
      std::string name(data.nameSize, '\0');
      read(name.data(), name.size());
      name.resize(std::strlen(name.c_str()));
      values += data.fileSize;
      info.grids.push_back(gridOf(data, std::move(name)));
    }
    if (values > file.size() - at) throw FileError(path, "is cut short; export it again");
    at += values;
  }
  if (info.grids.empty()) throw FileError(path, "is no NanoVDB file");
  return info;
}

}  // namespace innermap
