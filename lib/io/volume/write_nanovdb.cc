// NanoVDB files, by NanoVDB's own headers.
#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <set>

#include "core/file.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "io/volume/detail/volume_formats.h"

#define NANOVDB_USE_ZIP
#define NANOVDB_USE_TBB
#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>

namespace innermap {
namespace {

// Zeroed, which NanoVDB's own is not: what lies between its members would be whatever the process
// had there, another time something else.
class ZeroBuffer {
 public:
  static ZeroBuffer create(std::uint64_t size, const ZeroBuffer* = nullptr) {
    ZeroBuffer buffer;
    buffer.words_.reset(new Word[(size + sizeof(Word) - 1) / sizeof(Word)]());
    buffer.size_ = size;
    return buffer;
  }
  std::uint8_t* data() { return reinterpret_cast<std::uint8_t*>(words_.get()); }
  const std::uint8_t* data() const { return reinterpret_cast<const std::uint8_t*>(words_.get()); }
  std::uint64_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  void clear() {
    words_.reset();
    size_ = 0;
  }

 private:
  struct alignas(NANOVDB_DATA_ALIGNMENT) Word {
    std::uint8_t bytes[NANOVDB_DATA_ALIGNMENT];
  };
  std::unique_ptr<Word[]> words_;
  std::uint64_t size_ = 0;
};
using Handle = nanovdb::GridHandle<ZeroBuffer>;

template <class To, class Grid>
Handle converted(const Grid& grid) {
  using Open = typename Grid::TreeType;
  return nanovdb::openToNanoVDB<ZeroBuffer, Open, To>(grid, nanovdb::StatsMode::All,
                                                      nanovdb::ChecksumMode::Full);
}

// The same values and states as another type; OpenVDB itself converts no vectors.
template <class To, class From>
typename To::Ptr copyAs(const From& from) {
  using Value = typename To::ValueType;
  using Tree = typename To::TreeType;
  const auto tree =
      std::make_shared<Tree>(from.tree(), Value(from.background()), openvdb::TopologyCopy());
  std::uint64_t count = 0;
  auto to = tree->beginValueAll();
  for (auto value = from.cbeginValueAll(); value; ++value, ++to) {
    if (++count % 65536 == 0) throwIfCancelled();
    to.setValue(Value(*value));
  }
  const auto out = To::create(tree);
  out->insertMeta(from);
  out->setTransform(from.constTransform().copy());
  return out;
}

// The grid as one of those types that NanoVDB's readers know; null when it is none of others.
template <class To>
typename To::Ptr asType(const openvdb::GridBase& grid) {
  using From = openvdb::TypeList<openvdb::DoubleGrid, openvdb::Vec3DGrid, openvdb::Vec3IGrid>;
  typename To::Ptr out;
  grid.apply<From>([&](const auto& typed) {
    using Value = typename std::decay_t<decltype(typed)>::ValueType;
    constexpr bool kVector = openvdb::VecTraits<Value>::IsVec;
    if constexpr (kVector == openvdb::VecTraits<typename To::ValueType>::IsVec)
      out = copyAs<To>(typed);
  });
  return out;
}

Handle floats(const openvdb::FloatGrid& grid, bool half) {
  return half ? converted<nanovdb::Fp16>(grid) : converted<float>(grid);
}

Handle nanoGrid(const openvdb::GridBase& grid, bool half) {
  if (const auto copy = asType<openvdb::FloatGrid>(grid)) return floats(*copy, half);
  if (const auto copy = asType<openvdb::Vec3SGrid>(grid)) return converted<nanovdb::Vec3f>(*copy);
  Handle handle;
  using Own = openvdb::TypeList<openvdb::FloatGrid, openvdb::Vec3SGrid, openvdb::Int32Grid,
                                openvdb::Int64Grid, openvdb::BoolGrid, openvdb::MaskGrid>;
  const bool known = grid.apply<Own>([&](const auto& typed) {
    using Grid = std::decay_t<decltype(typed)>;
    if constexpr (std::is_same_v<Grid, openvdb::FloatGrid>)
      handle = floats(typed, half);
    else
      handle = converted<typename nanovdb::OpenToNanoType<typename Grid::BuildType>::Type>(typed);
  });
  if (!known)
    throw DataError(fmt::format("grid '{}' has the type {}, which NanoVDB files do not hold",
                                grid.getName(), grid.valueType()));
  return handle;
}

void check(const openvdb::GridPtrVec& grids) {
  if (grids.empty()) throw DataError("there are no grids to export");
  std::set<std::string> names;
  for (const auto& grid : grids) {
    const std::string name = grid->getName();
    if (name.empty()) throw DataError("a grid has no name, by which it could be found; name it");
    if (!names.insert(name).second)
      throw DataError(fmt::format("two grids are named '{}'; rename one", name));
    if (name.size() >= nanovdb::GridData::MaxNameSize)
      throw DataError(fmt::format("the grid name '{}' is too long for NanoVDB; shorten it", name));
    if (grid->empty())
      throw DataError(
          fmt::format("grid '{}' has no active voxel, so there is nothing to export", name));
    if (!grid->constTransform().isLinear())
      throw DataError(fmt::format(
          "grid '{}' has a frustum transform, which NanoVDB does not hold; resample it", name));
  }
}

}  // namespace

VolumeTextureResult planNanoVdb(const std::string& path, const openvdb::GridPtrVec& grids,
                                const VolumeTextureSettings&) {
  check(grids);
  VolumeTextureResult result;
  result.files = {path};
  for (const auto& grid : grids) result.channels.push_back(grid->getName());
  return result;
}

std::uint64_t nanoVdbMemory(const openvdb::GridPtrVec& grids,
                            const VolumeTextureSettings& settings) {
  // A grid at a time: perhaps as another type, its buffer, that compressed.
  std::uint64_t most = 0;
  for (const auto& grid : grids) most = std::max<std::uint64_t>(most, grid->memUsage());
  return (settings.zip ? 3 : 2) * (most + most / 8) + (std::uint64_t(1) << 20);
}

VolumeTextureResult writeNanoVdb(const std::string& path, const openvdb::GridPtrVec& grids,
                                 const VolumeTextureSettings& settings) {
  const VolumeTextureResult result = planNanoVdb(path, grids, settings);
  const auto codec = settings.zip ? nanovdb::io::Codec::ZIP : nanovdb::io::Codec::NONE;
  writeWholeFile(path, [&](std::ostream& stream) {
    for (std::size_t i = 0; i < grids.size(); ++i) {
      reportProgress("writing the NanoVDB file",
                     static_cast<double>(i) / static_cast<double>(grids.size()));
      const Handle handle = nanoGrid(*grids[i], settings.half);
      throwIfCancelled();
      errno = 0;
      try {
        nanovdb::io::writeGrid(stream, handle, codec);
      } catch (const std::runtime_error&) {
        throw FileError(path, fmt::format("cannot be written ({}); free some space",
                                          errno ? std::strerror(errno) : "write error"));
      }
    }
    reportProgress("writing the NanoVDB file", 1);
  });
  return result;
}

}  // namespace innermap
