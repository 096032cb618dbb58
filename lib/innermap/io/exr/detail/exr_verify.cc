#include "innermap/io/exr/detail/exr_verify.h"

#include <algorithm>
#include <array>
#include <map>

#include "innermap/core/error.h"
#include "innermap/io/vdb/detail/vdb_stream.h"

namespace innermap {
namespace {

constexpr std::int32_t kMagic = 20000630, kMultiPart = 0x1000;
constexpr std::size_t kLongestName = 255;
constexpr std::int64_t kMostInflated = 1040;  // bytes of what zlib makes one of
constexpr std::int64_t kChannel = 16;         // bytes of a channel after its name

// OpenEXR reads a value by its type, whatever length the header gives it.
const std::map<std::string, std::int64_t>& lengths() {
  static const std::map<std::string, std::int64_t> known{
      {"box2i", 16},      {"box2f", 16},   {"chromaticities", 32},
      {"compression", 1}, {"double", 8},   {"envmap", 1},
      {"float", 4},       {"int", 4},      {"keycode", 28},
      {"lineOrder", 1},   {"m33f", 36},    {"m33d", 72},
      {"m44f", 64},       {"m44d", 128},   {"rational", 8},
      {"timecode", 8},    {"tiledesc", 9}, {"v2i", 8},
      {"v2f", 8},         {"v2d", 16},     {"v3i", 12},
      {"v3f", 12},        {"v3d", 24},     {"deepImageState", 1}};
  return known;
}

// What of a part's header decides how many chunks it has.
struct PartSize {
  std::array<std::int32_t, 4> window{0, 0, 0, 0};  // x, y of the least, of the greatest pixel
  std::array<std::uint32_t, 2> tile{0, 0};
  int compression = 0;
};

class Walk {
 public:
  Walk(const std::string& path, std::istream& stream, std::uint64_t size)
      : path_(path), stream_(stream), size_(size) {}

  void run() {
    if (size_ < 8 || number() != kMagic) fail("is not an EXR file");
    const bool multiPart = (number() & kMultiPart) != 0;
    std::uint64_t chunks = 0;
    for (PartSize part; header(part); part = {}) {
      chunks += chunksOf(part);
      if (chunks > size_ / 8) fail("is truncated or damaged: it is too short for its pixels");
      if (!multiPart) break;
    }
  }

 private:
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
      if (!fits(type, length)) fail("is damaged: an attribute has not the length of its type");
      stream_.seekg(static_cast<std::streamoff>(begin));
      note(key, length, part);
      stream_.seekg(static_cast<std::streamoff>(begin + static_cast<std::uint64_t>(length)));
    }
    return any;
  }

  // Whether what is read of a value, and allocated for it, is what `length` says.
  bool fits(const std::string& type, std::int64_t length) {
    if (const auto fixed = lengths().find(type); fixed != lengths().end())
      return length == fixed->second;
    if (type == "preview") {
      if (length < 8) return false;
      const auto width = static_cast<std::uint32_t>(number()),
                 height = static_cast<std::uint32_t>(number());
      return std::uint64_t(width) * height <= size_ &&
             8 + 4 * std::uint64_t(width) * height == static_cast<std::uint64_t>(length);
    }
    if (type == "stringvector") {
      while (length >= 4) {
        const std::int64_t text = number();
        if (text < 0 || text > length - 4) return false;
        stream_.seekg(text, std::ios::cur);
        length -= 4 + text;
      }
      return length == 0;
    }
    if (type == "idmanifest") {
      if (length < 4) return false;
      return static_cast<std::uint32_t>(number()) <= kMostInflated * length;
    }
    if (type == "chlist") {
      for (std::string channel = name(); !channel.empty(); channel = name()) {
        length -= static_cast<std::int64_t>(channel.size()) + 1 + kChannel;
        stream_.seekg(kChannel, std::ios::cur);
      }
      return length == 1;
    }
    return true;
  }

  void note(const std::string& key, std::int64_t length, PartSize& part) {
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
    const auto parts = [](std::int64_t count, std::int64_t each) {
      return static_cast<std::uint64_t>((count + each - 1) / each);
    };
    if (part.tile[0] > 0 && part.tile[1] > 0)
      return parts(columns, part.tile[0]) * parts(rows, part.tile[1]);
    const auto kind = static_cast<std::size_t>(std::clamp(part.compression, 0, 9));
    return parts(rows, kLines[kind]);
  }

  const std::string& path_;
  std::istream& stream_;
  std::uint64_t size_;
};

}  // namespace

void verifyExr(const std::string& path, std::istream& stream, std::uint64_t size) {
  Walk(path, stream, size).run();
}

void verifyIfExr(const std::string& path, const Progress* progress) {
  CheckedInputBuffer buffer(path, progress);
  std::istream stream(&buffer);
  stream.exceptions(std::ios::badbit | std::ios::failbit);
  if (buffer.size() < 4 || stream.get() != 0x76 || stream.get() != 0x2f || stream.get() != 0x31 ||
      stream.get() != 0x01)
    return;
  stream.seekg(0);
  verifyExr(path, stream, buffer.size());
}

}  // namespace innermap
