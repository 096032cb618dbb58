#include "io/vdb/detail/vdb_verify.h"

#include <fmt/format.h>
#include <openvdb/Grid.h>
#include <openvdb/io/Compression.h>

#include <array>
#include <bitset>
#include <cstring>
#include <map>
#include <optional>
#include <set>

#include "innermap/core/error.h"

namespace innermap {
namespace {

constexpr std::uint32_t kOldest = 222, kNewest = 224;
constexpr std::uint32_t kZip = 1, kActiveMask = 2, kBlosc = 4;
constexpr std::int64_t kMagic = 0x56444220;
constexpr std::uint32_t kMostGrids = 10000;

enum class LeafKind { values, truth, mask };

struct ValueType {
  std::uint64_t size = 0;      // of a value in memory and in the file
  std::uint64_t halfSize = 0;  // in the file when saved as half floats
  LeafKind leaf = LeafKind::values;
};

std::optional<ValueType> valueTypeOf(const std::string& gridType) {
  static const std::map<std::string, ValueType> types = {{"float", {4, 2}},
                                                         {"double", {8, 2}},
                                                         {"int32", {4, 4}},
                                                         {"int64", {8, 8}},
                                                         {"bool", {1, 1, LeafKind::truth}},
                                                         {"mask", {1, 1, LeafKind::mask}},
                                                         {"vec3s", {12, 6}},
                                                         {"vec3d", {24, 6}},
                                                         {"vec3i", {12, 12}}};
  const std::string prefix = "Tree_", suffix = "_5_4_3";
  if (gridType.size() <= prefix.size() + suffix.size() || gridType.compare(0, 5, prefix) != 0 ||
      gridType.compare(gridType.size() - suffix.size(), suffix.size(), suffix) != 0)
    return std::nullopt;
  const auto found =
      types.find(gridType.substr(prefix.size(), gridType.size() - prefix.size() - suffix.size()));
  if (found == types.end()) return std::nullopt;
  return found->second;
}

// Sizes of the metadata types whose readers ignore the size that the file gives.
std::optional<std::uint32_t> metadataSize(const std::string& type) {
  static const std::map<std::string, std::uint32_t> sizes = {
      {"bool", 1},   {"float", 4},  {"double", 8}, {"half", 2},   {"int32", 4},  {"int64", 8},
      {"vec2i", 8},  {"vec2s", 8},  {"vec2d", 16}, {"vec3i", 12}, {"vec3s", 12}, {"vec3d", 24},
      {"vec4i", 16}, {"vec4s", 16}, {"vec4d", 32}, {"mat4s", 64}, {"mat4d", 128}};
  const auto found = sizes.find(type);
  if (found == sizes.end()) return std::nullopt;
  return found->second;
}

class Verifier {
 public:
  Verifier(const std::string& path, std::istream& stream, std::uint64_t size)
      : path_(path), stream_(stream), size_(size) {}

  std::vector<VerifiedGrid> run() {
    header();
    metadata();
    const std::uint32_t count = read<std::uint32_t>();
    if (count > kMostGrids) damaged("its number of grids is not credible");
    std::vector<VerifiedGrid> grids;
    for (std::uint32_t i = 0; i < count; ++i) grids.push_back(grid());
    return grids;
  }

 private:
  [[noreturn]] void damaged(const std::string& what) const {
    throw FileError(path_, "is truncated or damaged (" + what + "); write it again");
  }

  template <class T>
  T read() {
    T value;
    stream_.read(reinterpret_cast<char*>(&value), sizeof(T));
    return value;
  }

  std::uint64_t position() { return static_cast<std::uint64_t>(stream_.tellg()); }

  void skip(std::uint64_t bytes) {
    if (bytes > size_ - position()) damaged("a block is longer than the file");
    stream_.seekg(static_cast<std::streamoff>(bytes), std::ios::cur);
  }

  std::string text(std::uint32_t longest) {
    const auto length = read<std::uint32_t>();
    if (length > longest || length > size_ - position()) damaged("a name is longer than the file");
    std::string value(length, ' ');
    if (length) stream_.read(value.data(), length);
    return value;
  }

  void header() {
    if (size_ < 57 || read<std::int64_t>() != kMagic)
      throw FileError(path_, "is not an OpenVDB file; give a .vdb file");
    version_ = read<std::uint32_t>();
    if (version_ < kOldest)
      throw FileError(path_, fmt::format("has the old format version {}; save it again with "
                                         "OpenVDB 3 or later",
                                         version_));
    if (version_ > kNewest)
      throw FileError(path_, fmt::format("has format version {}, newer than {}, the newest that is "
                                         "known; save it for an older OpenVDB",
                                         version_, kNewest));
    skip(8);  // the library's version
    if (read<char>() != 1)
      throw FileError(path_, "has no grid offsets (it was written as a stream); save it as a file");
    skip(36);  // unique identifier
  }

  void metadata() {
    delayedLeaves_ = 0;
    const auto count = read<std::uint32_t>();
    std::set<std::string> names;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (text(1u << 16).empty()) damaged("metadata has no name");
      const std::string type = text(1u << 16);
      const auto size = read<std::uint32_t>();
      if (size > size_ - position()) damaged("metadata is longer than the file");
      const auto fixed = metadataSize(type);
      if (fixed && *fixed != size) damaged("metadata of type " + type + " has the wrong size");
      const std::uint64_t end = position() + size;
      if (type == "__delayedload") delayedLoad(end);
      // What is neither may count as both in what a compiler makes of it.
      if (type == "bool" && read<unsigned char>() > 1) damaged("a truth value is neither 0 nor 1");
      if (position() > end) damaged("metadata is longer than it says");
      skip(end - position());
    }
  }

  // Checks a grid's metadata. OpenVDB learns from them whether voxels are half floats, however the
  // descriptor's type ends; what it takes for true it decides itself.
  bool savedAsHalf() {
    const std::uint64_t begin = position();
    metadata();
    const std::uint64_t end = position();
    stream_.seekg(static_cast<std::streamoff>(begin));
    openvdb::MetaMap map;
    map.readMeta(stream_);
    if (position() != end) damaged("metadata is longer than it says");
    const openvdb::Metadata::Ptr half = map[openvdb::GridBase::META_SAVE_HALF_FLOAT];
    return half && half->asBool();
  }

  // What OpenVDB keeps of each leaf to load it lazily: a byte, and the length of its block.
  void delayedLoad(std::uint64_t end) {
    if (position() == end) return;
    delayedLeaves_ = read<std::uint32_t>();
    // A leaf takes more than its mask in the file; a compressed table may claim any number.
    if (delayedLeaves_ > size_ / 64) damaged("a table has more leaves than the file");
    for (const std::uint64_t valueSize : {1, 8}) {
      const auto bytes = read<std::uint32_t>();
      if (valueSize == 8 && bytes == ~std::uint32_t(0)) continue;  // no lengths are kept
      const std::uint64_t raw = valueSize * delayedLeaves_;
      const std::uint64_t stored = bytes ? bytes : raw;
      if (position() > end || stored > end - position())
        damaged("its table of leaves is longer than it says");
      // Small tables are padded before they are compressed.
      if (bytes)
        bloscBlock(stored, raw, raw + 128);
      else
        skip(stored);
    }
  }

  void transform() {
    static const std::map<std::string, std::uint64_t> sizes = {{"AffineMap", 128},
                                                               {"UnitaryMap", 128},
                                                               {"ScaleMap", 120},
                                                               {"UniformScaleMap", 120},
                                                               {"TranslationMap", 24},
                                                               {"ScaleTranslateMap", 144},
                                                               {"UniformScaleTranslateMap", 144}};
    std::string type = text(256);
    if (type == "NonlinearFrustumMap") {
      skip(64);
      type = text(256);
    }
    const auto found = sizes.find(type);
    if (found == sizes.end()) damaged("its transform is of an unknown type");
    skip(found->second);
  }

  VerifiedGrid grid() {
    text(1u << 16);  // the grid's name
    std::string type = text(256);
    const std::string halfSuffix = "_HalfFloat";
    if (type.size() > halfSuffix.size() &&
        type.compare(type.size() - halfSuffix.size(), halfSuffix.size(), halfSuffix) == 0)
      type.resize(type.size() - halfSuffix.size());
    const bool instance = !text(1u << 16).empty();
    const auto gridPosition = read<std::int64_t>(), blockPosition = read<std::int64_t>(),
               endPosition = read<std::int64_t>();
    VerifiedGrid result;
    result.begin = position();
    if (gridPosition != static_cast<std::int64_t>(result.begin) || endPosition < gridPosition ||
        endPosition > static_cast<std::int64_t>(size_))
      damaged("a grid's offsets do not fit the file");
    result.end = static_cast<std::uint64_t>(endPosition);
    compression_ = read<std::uint32_t>();
    half_ = savedAsHalf();
    transform();
    const auto value = valueTypeOf(type);
    result.readable = value.has_value();
    if (result.readable && !instance) {
      type_ = *value;
      tree(blockPosition);
      if (position() != result.end) damaged("a grid does not end where it says");
      result.leaves = leaves_;
      result.memory = memory_;
    }
    stream_.seekg(endPosition);
    return result;
  }

  void tree(std::int64_t blockPosition) {
    leaves_ = 0;
    inTopology_ = true;
    memory_ = 2000;  // the tree itself
    origins_.clear();
    if (read<std::int32_t>() != 1) damaged("a tree has several buffers");
    skip(type_.size);  // background
    const auto tiles = read<std::uint32_t>(), children = read<std::uint32_t>();
    std::set<Origin> keys;
    for (std::uint32_t i = 0; i < tiles; ++i) {
      rootKey(keys);
      skip(type_.size);
      if (read<unsigned char>() > 1) damaged("a tile's state is neither on nor off");
    }
    for (std::uint32_t i = 0; i < children; ++i) internal<5>(rootKey(keys));
    memory_ += 100 * keys.size();
    inTopology_ = false;
    if (static_cast<std::int64_t>(position()) != blockPosition)
      damaged("a grid's voxels do not begin where it says");
    if (delayedLeaves_ > leaves_) damaged("a table has more leaves than the grid");
    for (std::uint64_t leaf = 0; leaf < leaves_; ++leaf) leafBuffer(leaf);
  }

  using Origin = std::array<std::int32_t, 3>;

  Origin rootKey(std::set<Origin>& keys) {
    const auto key = read<Origin>();
    for (std::int32_t c : key)
      if (c % 4096 != 0) damaged("a root node has a wrong place");
    if (!keys.insert(key).second) damaged("a root node comes twice");
    return key;
  }

  template <std::size_t N>
  using Mask = std::bitset<N>;

  template <std::size_t N>
  Mask<N> mask() {
    static_assert(sizeof(Mask<N>) == N / 8);
    return read<Mask<N>>();
  }

  // An internal node of 2^kLog voxels or nodes a side, and its children.
  template <int kLog>
  void internal(const Origin& origin) {
    constexpr std::size_t kCount = std::size_t(1) << (3 * kLog);
    const Mask<kCount> children = mask<kCount>(), values = mask<kCount>();
    if ((children & values).any()) damaged("a node has both a child and a value in one place");
    compressedValues<kCount>(values);
    // A place holds a value or a pointer.
    memory_ += kCount * ((type_.size + 7) / 8 * 8) + 2 * kCount / 8 + 64;
    constexpr int kChildLog = kLog == 5 ? 7 : 3;  // voxels along a child's side
    for (std::size_t i = 0; i < kCount; ++i) {
      if (!children[i]) continue;
      const auto at = static_cast<std::int32_t>(i);
      constexpr std::int32_t kSide = 1 << kLog;
      const Origin child = {origin[0] + (at / (kSide * kSide)) * (1 << kChildLog),
                            origin[1] + (at / kSide % kSide) * (1 << kChildLog),
                            origin[2] + (at % kSide) * (1 << kChildLog)};
      if constexpr (kLog == 5)
        internal<4>(child);
      else
        leafTopology(child);
    }
  }

  void leafTopology(const Origin& origin) {
    skip(64);
    ++leaves_;
    memory_ += (type_.leaf == LeafKind::values ? 512 * type_.size : 64) + 144;
    if (type_.leaf != LeafKind::values) origins_.push_back(origin);
  }

  void leafBuffer(std::uint64_t leaf) {
    const Mask<512> values = mask<512>();
    if (type_.leaf == LeafKind::values) return compressedValues<512>(values);
    if (read<Origin>() != origins_[leaf]) damaged("a leaf node has a wrong place");
    if (type_.leaf == LeafKind::truth) skip(64);
  }

  template <std::size_t N>
  void compressedValues(const Mask<N>& active) {
    const auto flag = read<std::int8_t>();
    if (flag < 0 || flag > 6) damaged("a node has an unknown compression");
    const int inactive = flag == 5 ? 2 : flag == 2 || flag == 4 ? 1 : 0;
    skip(inactive * type_.size);
    if (flag >= 3 && flag <= 5) skip(N / 8);
    const bool onlyActive = (compression_ & kActiveMask) && flag != 6;
    block((onlyActive ? active.count() : N), half_ ? type_.halfSize : type_.size);
  }

  // A block of `count` values as OpenVDB's readData expects it.
  void block(std::uint64_t count, std::uint64_t valueSize) {
    // Half floats return early; other types have a length even for an empty block.
    if (count == 0 && half_ && type_.halfSize != type_.size) return;
    const std::uint64_t bytes = count * valueSize;
    if (!(compression_ & (kBlosc | kZip))) return skip(bytes);
    const std::uint64_t begin = position();
    const auto stored = read<std::int64_t>();
    if (stored <= 0) {
      if (stored == std::numeric_limits<std::int64_t>::min() ||
          static_cast<std::uint64_t>(-stored) != bytes)
        damaged("a block has the wrong length");
      return skip(bytes);
    }
    if (compression_ & kBlosc)
      bloscBlock(static_cast<std::uint64_t>(stored), bytes, bytes);
    else
      skip(static_cast<std::uint64_t>(stored));
    if (inTopology_) decode(begin, bytes);
  }

  // OpenVDB loses the nodes that it has made so far when it throws in the midst of the tree, so the
  // tree's own blocks, which are few, are tried first. What cannot be decoded in a leaf costs
  // nothing.
  void decode(std::uint64_t begin, std::uint64_t bytes) {
    const std::uint64_t end = position();
    stream_.seekg(static_cast<std::streamoff>(begin));
    decoded_.resize(bytes);
    if (compression_ & kBlosc)
      openvdb::io::bloscFromStream(stream_, decoded_.data(), bytes);
    else
      openvdb::io::unzipFromStream(stream_, decoded_.data(), bytes);
    if (position() != end) damaged("a block has the wrong length");
  }

  // Blosc's header gives the lengths again, and its decoder believes them.
  void bloscBlock(std::uint64_t stored, std::uint64_t least, std::uint64_t most) {
    if (stored < 16 || stored > size_ - position()) damaged("a block has the wrong length");
    const auto head = read<std::array<std::uint32_t, 4>>();
    if (head[3] != stored || head[1] < least || head[1] > most)
      damaged("a block has the wrong length");
    skip(stored - sizeof(head));
  }

  const std::string& path_;
  std::istream& stream_;
  const std::uint64_t size_;
  std::uint32_t version_ = 0, compression_ = 0, delayedLeaves_ = 0;
  bool half_ = false, inTopology_ = false;
  std::vector<char> decoded_;
  ValueType type_;
  std::uint64_t leaves_ = 0, memory_ = 0;
  std::vector<Origin> origins_;  // of bool and mask leaves, which repeat theirs
};

}  // namespace

std::vector<VerifiedGrid> verifyVdb(const std::string& path, std::istream& stream,
                                    std::uint64_t size) {
  return Verifier(path, stream, size).run();
}

}  // namespace innermap
