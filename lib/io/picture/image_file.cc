#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string_view>
#include <utility>

#include "core/file_bytes.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/io/pictures.h"
#include "io/exr/detail/exr_verify.h"
#include "io/picture/detail/image_library.h"

namespace innermap {
namespace {

constexpr int kMostPixels = 1 << 16;  // along a side

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string firstLine(const std::string& text) { return text.substr(0, text.find('\n')); }

// What OpenImageIO calls the format: by the first bytes, else by the ending. It would try a file
// that is not what its ending says as everything that it knows, films and scans of hospitals
// included, in turn: slow, and each of these readers is one more that a damaged file could break.
std::string formatOf(const std::string& path) {
  static constexpr std::pair<std::string_view, const char*> kStarts[] = {
      {"\x89PNG", "png"},     {"\xff\xd8\xff", "jpeg"}, {"\x76\x2f\x31\x01", "openexr"},
      {{"II*\0", 4}, "tiff"}, {{"MM\0*", 4}, "tiff"},   {{"II+\0", 4}, "tiff"},
      {{"MM\0+", 4}, "tiff"}, {"#?RADIANCE", "hdr"},    {"#?RGBE", "hdr"}};
  std::string head(16, '\0');
  std::ifstream(path, std::ios::binary)
      .read(head.data(), static_cast<std::streamsize>(head.size()));
  for (const auto& [start, format] : kStarts)
    if (head.compare(0, start.size(), start) == 0) return format;
  const std::string extension = extensionOf(path);
  return extension.empty() ? "" : lower(extension.substr(1));
}

std::unique_ptr<ImageReader> open(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    throw FileError(path, "does not exist; give the path of an image");
  if (std::filesystem::is_directory(path, ignored))
    throw FileError(path, "is a folder; give the path of an image");
  const auto fail = [&](const std::string& why) {
    throw FileError(path, fmt::format("is no image that can be read ({}); give a .png, .jpg, .tif, "
                                      ".exr or another format of OpenImageIO",
                                      firstLine(why)));
  };
  const std::string format = formatOf(path);
  if (format == "openexr") verifyExr(path);
  if (format.empty()) fail("its name has no ending and its first bytes are of no known format");
  std::string why;
  std::unique_ptr<ImageReader> input = imageLibrary().open(path, format, why);
  if (!input) fail(why);
  const ImageInfo& info = input->info();
  if (info.deep) throw FileError(path, "is a deep image; flatten it first");
  if (info.depth > 1 || info.fullDepth > 1) throw FileError(path, "is a volume, not an image");
  for (const int side : {info.width, info.height, info.fullWidth, info.fullHeight})
    if (side < 1 || side > kMostPixels)
      throw FileError(path,
                      fmt::format("says that it is {} x {} pixels; it must have 1 to {} along "
                                  "each side",
                                  info.fullWidth, info.fullHeight, kMostPixels));
  return input;
}

// Which channels of the file are red, green, blue and alpha. -1: none.
struct Channels {
  int colour[3] = {-1, -1, -1}, alpha = -1;

  int begin() const {
    int first = std::min({colour[0], colour[1], colour[2]});
    return alpha >= 0 ? std::min(first, alpha) : first;
  }
  int end() const { return std::max({colour[0], colour[1], colour[2], alpha}) + 1; }
};

// Index of a channel of this name in a layer ("diffuse." or none).
int channelNamed(const std::vector<std::string>& names, const std::string& layer,
                 std::initializer_list<const char*> wanted) {
  for (std::size_t i = 0; i < names.size(); ++i)
    for (const char* name : wanted)
      if (lower(names[i]) == layer + name) return static_cast<int>(i);
  return -1;
}

Channels channelsIn(const std::vector<std::string>& names, const std::string& layer) {
  Channels c;
  c.colour[0] = channelNamed(names, layer, {"r", "red"});
  c.colour[1] = channelNamed(names, layer, {"g", "green"});
  c.colour[2] = channelNamed(names, layer, {"b", "blue"});
  c.alpha = channelNamed(names, layer, {"a", "alpha"});
  if (c.colour[0] >= 0 && c.colour[1] >= 0 && c.colour[2] >= 0) return c;
  // X beside Y: a vector.
  const bool vector = channelNamed(names, layer, {"x"}) >= 0;
  int grey = vector ? -1 : channelNamed(names, layer, {"y", "i", "l", "v", "gray", "grey"});
  if (grey < 0 && c.colour[1] < 0 && c.colour[2] < 0) grey = c.colour[0];
  c.colour[0] = c.colour[1] = c.colour[2] = grey;
  return c;
}

Channels channelsOf(const std::string& path, const ImageInfo& info) {
  const std::vector<std::string>& names = info.channels;
  Channels found = channelsIn(names, "");
  for (std::size_t i = 0; i < names.size() && found.colour[0] < 0; ++i)
    if (const std::size_t dot = names[i].rfind('.'); dot != std::string::npos)
      found = channelsIn(names, lower(names[i].substr(0, dot + 1)));
  // Formats without names call them by number.
  if (found.colour[0] < 0 && !names.empty() && lower(names[0]).rfind("channel", 0) == 0)
    for (int c = 0; c < 3; ++c) found.colour[c] = names.size() >= 3 ? c : 0;
  if (found.colour[0] < 0)
    throw FileError(path, fmt::format("has no colour channels, only {}; give an image with R, G, B "
                                      "or Y",
                                      fmt::join(names, ", ")));
  return found;
}

// The function that makes a file's numbers linear, and its name.
struct Decoding {
  std::string name = "linear";
  std::function<double(double)> decode;  // none: they are
};

double linearFromRec709(double v) {
  return v < 0.081 ? v / 4.5 : std::pow((v + 0.099) / 1.099, 1 / 0.45);
}

Decoding gammaDecoding(double gamma) {
  return {fmt::format("gamma {:g}", gamma),
          [gamma](double v) { return v > 0 ? std::pow(v, gamma) : 0.0; }};
}

Decoding decodingOf(const ImageInfo& info, ColourSpace wanted, std::vector<std::string>& notes) {
  const Decoding linear, srgb{"sRGB", linearFromSrgb};
  if (wanted == ColourSpace::linear) return linear;
  if (wanted == ColourSpace::srgb) return srgb;
  const Decoding byType = info.numberBytes == 1 ? srgb : linear;
  const std::string& name = info.colourSpace;
  const std::string key = lower(name);
  if (key.empty()) return byType;
  if (key == "srgb" || key == "srgb_texture" || key == "srgb_tx") return srgb;
  if (key == "linear" || key == "scene_linear" || key == "raw" || key == "data" ||
      key.rfind("lin_", 0) == 0)
    return linear;
  if (key == "rec709") return {"Rec. 709", linearFromRec709};
  if (key.rfind("gamma", 0) == 0) {
    const double stated = std::atof(key.c_str() + 5);
    const double value = stated > 0 ? stated : info.gamma;
    if (value > 0.1 && value < 10) return gammaDecoding(value);
  }
  notes.push_back(
      fmt::format("its colour space '{}' is not known here; read as {}", name, byType.name));
  return byType;
}

std::uint64_t memoryOf(const ImageInfo& info, const Channels& channels) {
  const std::uint64_t file = std::uint64_t(info.width) * info.height;
  const std::uint64_t full = std::uint64_t(info.fullWidth) * info.fullHeight;
  return file * static_cast<std::uint64_t>(channels.end() - channels.begin()) * sizeof(float) +
         full * 3 * sizeof(float) * 4 / 3;
}

bool stopWhenCancelled(void* opaque, float done) {
  auto* run = static_cast<RunContext*>(opaque);
  if (!run) return false;
  if (!run->cancelled()) run->report("reading the image", done);
  return run->cancelled();
}

// From the file's pixels, `stride` floats each, to the picture's place in the display window.
class Placing {
 public:
  Placing(const ImageInfo& info, const Channels& channels, const Decoding& decoding)
      : info_(info), channels_(channels), decoding_(decoding) {
    first_ = channels.begin();
    stride_ = channels.end() - first_;
    divide_ = channels.alpha >= 0 && !info.alphaIsDivided;
  }

  void row(const std::vector<float>& from, int y, Pixels& to, std::size_t& broken) const {
    const int ty = y + info_.y - info_.fullY;
    if (ty < 0 || ty >= to.height) return;
    for (int x = 0; x < info_.width; ++x) {
      const int tx = x + info_.x - info_.fullX;
      if (tx < 0 || tx >= to.width) continue;
      const float* p = &from[(std::size_t(y) * info_.width + x) * stride_];
      float* q = &to.rgb[3 * (std::size_t(ty) * to.width + tx)];
      const double alpha = divide_ ? p[channels_.alpha - first_] : 1;
      for (int c = 0; c < 3; ++c) {
        double v = p[channels_.colour[c] - first_];
        if (alpha > 0 && alpha < 1) v /= alpha;
        if (decoding_.decode) v = decoding_.decode(v);
        const auto value = static_cast<float>(v);
        if (!std::isfinite(value)) ++broken;
        q[c] = std::isfinite(value) ? value : 0.0f;
      }
    }
  }

 private:
  const ImageInfo& info_;
  const Channels& channels_;
  const Decoding& decoding_;
  int first_ = 0, stride_ = 1;
  bool divide_ = false;
};

}  // namespace

double linearFromSrgb(double v) {
  if (v < 0) return -linearFromSrgb(-v);
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

std::uint64_t imageMemory(const std::string& path) {
  const std::unique_ptr<ImageReader> input = open(path);
  return memoryOf(input->info(), channelsOf(path, input->info()));
}

ImageFile readImage(const std::string& path, const ImageSettings& settings) {
  const std::unique_ptr<ImageReader> input = open(path);
  const ImageInfo& info = input->info();
  const Channels channels = channelsOf(path, info);
  requireMemory("the image " + path, memoryOf(info, channels),
                "make it smaller or raise --max-memory");
  ImageFile out;
  const Decoding decoding = decodingOf(info, settings.colourSpace, out.notes);
  out.colourSpace = decoding.name;
  const bool grey = channels.colour[0] == channels.colour[1];
  for (int c = 0; c < (grey ? 1 : 3); ++c)
    out.channels += (c ? "," : "") + info.channels[static_cast<std::size_t>(channels.colour[c])];

  const auto stride = static_cast<std::size_t>(channels.end() - channels.begin());
  std::vector<float> raw(std::size_t(info.width) * info.height * stride);
  std::string why;
  const bool whole = input->read(channels.begin(), channels.end(), raw.data(), stopWhenCancelled,
                                 currentRun(), why);
  throwIfCancelled();
  if (!whole) throw FileError(path, fmt::format("is damaged or cut short ({})", firstLine(why)));
  out.pixels.width = info.fullWidth;
  out.pixels.height = info.fullHeight;
  out.pixels.rgb.assign(std::size_t(3) * info.fullWidth * info.fullHeight, 0.0f);
  const Placing placing(info, channels, decoding);
  std::atomic<std::size_t> broken{0};
  parallelBlocks(static_cast<std::size_t>(info.height), 16,
                 [&](std::size_t begin, std::size_t end) {
                   std::size_t count = 0;
                   for (std::size_t y = begin; y < end; ++y)
                     placing.row(raw, static_cast<int>(y), out.pixels, count);
                   broken += count;
                 });
  if (broken > 0)
    out.notes.push_back(fmt::format("{} numbers are not finite; taken as 0", broken.load()));
  if (channels.alpha >= 0) out.notes.emplace_back("its alpha channel is left out");
  return out;
}

}  // namespace innermap
