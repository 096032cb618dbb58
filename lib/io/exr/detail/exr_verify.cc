#include "io/exr/detail/exr_verify.h"

#include <algorithm>
#include <array>
#include <map>
#include <string_view>

#include "innermap/core/error.h"
#include "io/vdb/detail/vdb_stream.h"

namespace innermap {
namespace {

constexpr std::int32_t kMagic = 20000630, kTiled = 0x200, kMultiPart = 0x1000;
constexpr std::int32_t kLastPixelType = 2;  // unsigned, half, float
constexpr std::size_t kLongestName = 255;
constexpr std::uint64_t kTilePixels = std::uint64_t(1) << 22;  // whatever the picture's size

// What of a part's header decides how many chunks it has.
struct PartSize {
  std::array<std::int32_t, 4> window{0, 0, 0, 0};  // x, y of the least, of the greatest pixel
  std::array<std::uint32_t, 2> tile{0, 0};
  int compression = 0;
  std::string type;
  std::int64_t chunks = 0;
};

// Types whose readers take what they need and ignore the length that the file gives.
const std::map<std::string_view, std::int64_t>& fixedLengths() {
  static const std::map<std::string_view, std::int64_t> lengths = {{"box2i", 16},
                                                                   {"box2f", 16},
                                                                   {"chromaticities", 32},
                                                                   {"compression", 1},
                                                                   {"double", 8},
                                                                   {"envmap", 1},
                                                                   {"float", 4},
                                                                   {"int", 4},
                                                                   {"keycode", 28},
                                                                   {"m33f", 36},
                                                                   {"lineOrder", 1},
                                                                   {"m33d", 72},
                                                                   {"m44f", 64},
                                                                   {"m44d", 128},
                                                                   {"rational", 8},
                                                                   {"deepImageState", 1},
                                                                   {"tiledesc", 9},
                                                                   {"v2i", 8},
                                                                   {"v2f", 8},
                                                                   {"v2d", 16},
                                                                   {"timecode", 8},
                                                                   {"v3i", 12},
                                                                   {"v3f", 12},
                                                                   {"v3d", 24}};
  return lengths;
}

class Walk {
 public:
  Walk(const std::string& path, std::istream& stream, std::uint64_t size)
      : path_(path), stream_(stream), size_(size) {}

  void run() {
    if (size_ < 8 || number() != kMagic) fail("is not an EXR file");
    flags_ = number();
    std::uint64_t chunks = 0;
    for (PartSize part; header(part); part = {}) {
      chunks += chunksOf(part);
      if (chunks > size_ / 8) fail("is truncated or damaged: it is too short for its pixels");
      if (!multiPart()) break;
    }
  }

 private:
  bool multiPart() const { return (flags_ & kMultiPart) != 0; }

  [[noreturn]] void fail(const char* what) const { throw FileError(path_, what); }

  std::int32_t number() {
    unsigned char b[4];
    stream_.read(reinterpret_cast<char*>(b), 4);
    return static_cast<std::int32_t>(b[0] | b[1] << 8 | b[2] << 16 | std::uint32_t(b[3]) << 24);
  }

  std::string name() {
    std::string text;
    for (char c = 0; stream_.get(c) && c != 0;) {
      if (text.size() == kLongestName) fail("is damaged: a name in its header does not end");
      text += c;
    }
    return text;
  }

  // False for the empty one that ends the headers of a file of several parts.
  bool header(PartSize& part) {
    bool any = false;
    for (std::string key = name(); !key.empty(); key = name(), any = true) {
      const std::string type = name();
      const std::int64_t length = number();
      const auto begin = static_cast<std::uint64_t>(stream_.tellg());
      if (length < 0 || static_cast<std::uint64_t>(length) > size_ - std::min(size_, begin))
        fail("is truncated or damaged: an attribute is longer than the file");
      const std::uint64_t end = begin + static_cast<std::uint64_t>(length);
      walk(type, length, end);
      stream_.seekg(static_cast<std::streamoff>(begin));
      note(key, type, length, part);
      stream_.seekg(static_cast<std::streamoff>(end));
    }
    return any;
  }

  std::uint64_t position() { return static_cast<std::uint64_t>(stream_.tellg()); }

  // Goes through the value as OpenEXR does, which must end where the file says.
  void walk(const std::string& type, std::int64_t length, std::uint64_t end) {
    const auto wrong = [&] { fail("is damaged: an attribute has the wrong length"); };
    const auto found = fixedLengths().find(type);
    if (found != fixedLengths().end() && found->second != length) wrong();
    const auto skip = [&](std::uint64_t bytes) {
      if (position() > end || bytes > end - position()) wrong();
      stream_.seekg(static_cast<std::streamoff>(bytes), std::ios::cur);
    };
    if (type == "chlist") {
      // OpenImageIO ends the program where there is none, or one of an unknown type.
      if (name().empty()) fail("has no channels");
      do {
        const std::int32_t pixels = number();
        if (pixels < 0 || pixels > kLastPixelType)
          fail("is damaged: a channel is of no known type");
        skip(12);
      } while (!name().empty());
      if (position() != end) wrong();
    } else if (type == "preview") {
      if (length < 8) wrong();
      const std::uint64_t width = static_cast<std::uint32_t>(number()),
                          height = static_cast<std::uint32_t>(number());
      if (height > 0 && width > size_ / height) wrong();
      skip(4 * width * height);
      if (position() != end) wrong();
    } else if (type == "stringvector") {
      while (position() < end) {
        if (end - position() < 4) wrong();
        const std::int32_t text = number();
        if (text < 0) wrong();
        skip(static_cast<std::uint64_t>(text));
      }
    } else if (type == "floatvector" && length % 4 != 0) {
      wrong();
    }
  }

  void note(const std::string& key, const std::string& type, std::int64_t length, PartSize& part) {
    if (key == "type" && type == "string") {
      part.type.resize(static_cast<std::size_t>(std::min<std::int64_t>(length, kLongestName)));
      stream_.read(part.type.data(), static_cast<std::streamsize>(part.type.size()));
    }
    if (key == "chunkCount" && length == 4) part.chunks = number();
    if (key == "dataWindow" && length == 16)
      for (std::int32_t& side : part.window) side = number();
    if (key == "tiles" && length == 9)
      for (std::uint32_t& side : part.tile) side = static_cast<std::uint32_t>(number());
    if (key == "compression" && length == 1) part.compression = stream_.get();
  }

  std::uint64_t chunksOf(const PartSize& part) const {
    static constexpr std::array<int, 10> kLines{1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
    const auto& w = part.window;
    const std::int64_t columns = std::int64_t(w[2]) - w[0] + 1,
                       rows = std::int64_t(w[3]) - w[1] + 1;
    if (columns < 1 || rows < 1) fail("is damaged: its data window is empty");
    if (part.chunks < 0) fail("is damaged: its number of chunks is negative");
    const auto parts = [](std::int64_t count, std::int64_t each) {
      return static_cast<std::uint64_t>((count + each - 1) / each);
    };
    // Where flags and type contradict each other, OpenEXR goes by the one or the other.
    const bool tiledType = part.type == "tiledimage" || part.type == "deeptile";
    const bool tiledFlag = (flags_ & kTiled) != 0;
    std::uint64_t chunks = static_cast<std::uint64_t>(part.chunks);
    if (tiledType || tiledFlag) {
      const std::uint64_t width = part.tile[0], height = part.tile[1];
      if (width == 0 || height == 0) fail("is damaged: its tiles have no size");
      // Smaller ones than the picture are usual, larger ones for small pictures too.
      const auto pixels = static_cast<std::uint64_t>(columns) * static_cast<std::uint64_t>(rows);
      if (width > (std::uint64_t(1) << 31) / height ||
          width * height > std::max(4 * pixels, kTilePixels))
        fail("is damaged: its tiles are far larger than its picture");
      chunks = std::max(chunks, parts(columns, part.tile[0]) * parts(rows, part.tile[1]));
    }
    if (!tiledFlag || (!part.type.empty() && !tiledType)) {
      const auto kind = static_cast<std::size_t>(std::clamp(part.compression, 0, 9));
      if (!tiledType || !multiPart()) chunks = std::max(chunks, parts(rows, kLines[kind]));
    }
    return chunks;
  }

  const std::string& path_;
  std::istream& stream_;
  std::uint64_t size_;
  std::int32_t flags_ = 0;
};

}  // namespace

void verifyExr(const std::string& path, std::istream& stream, std::uint64_t size) {
  Walk(path, stream, size).run();
}

void verifyExr(const std::string& path) {
  CheckedInputBuffer buffer(path);
  std::istream stream(&buffer);
  stream.exceptions(std::ios::badbit | std::ios::failbit);
  verifyExr(path, stream, buffer.size());
}

}  // namespace innermap
