#include "innermap/io/picture/image_file.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <functional>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/parallel.h"
#include "innermap/io/exr/detail/exr_verify.h"

namespace innermap {
namespace {

constexpr int kMostPixels = 1 << 16;  // along a side

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string firstLine(const std::string& text) { return text.substr(0, text.find('\n')); }

using Input = std::unique_ptr<OIIO::ImageInput>;

Input open(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    throw FileError(path, "does not exist; give the path of an image");
  if (std::filesystem::is_directory(path, ignored))
    throw FileError(path, "is a folder; give the path of an image");
  verifyIfExr(path, nullptr);
  OIIO::ImageSpec wanted;
  wanted.attribute("oiio:UnassociatedAlpha", 1);
  Input input = OIIO::ImageInput::open(path, &wanted);
  if (!input)
    throw FileError(path, fmt::format("is no image that can be read ({}); give a .png, .jpg, .tif, "
                                      ".exr or another format of OpenImageIO",
                                      firstLine(OIIO::geterror())));
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.deep) throw FileError(path, "is a deep image; flatten it first");
  if (spec.depth > 1 || spec.full_depth > 1) throw FileError(path, "is a volume, not an image");
  for (const int side : {spec.width, spec.height, spec.full_width, spec.full_height})
    if (side < 1 || side > kMostPixels)
      throw FileError(path,
                      fmt::format("says that it is {} x {} pixels; it must have 1 to {} along "
                                  "each side",
                                  spec.full_width, spec.full_height, kMostPixels));
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

Channels channelsOf(const std::string& path, const OIIO::ImageSpec& spec) {
  const std::vector<std::string>& names = spec.channelnames;
  Channels found = channelsIn(names, "");
  for (std::size_t i = 0; i < names.size() && found.colour[0] < 0; ++i)
    if (const std::size_t dot = names[i].rfind('.'); dot != std::string::npos)
      found = channelsIn(names, lower(names[i].substr(0, dot + 1)));
  // Formats without names call them by number.
  if (found.colour[0] < 0 && !names.empty() && lower(names[0]).rfind("channel", 0) == 0)
    for (int c = 0; c < 3; ++c) found.colour[c] = spec.nchannels >= 3 ? c : 0;
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

Decoding decodingOf(const OIIO::ImageSpec& spec, ColourSpace wanted,
                    std::vector<std::string>& notes) {
  const Decoding linear, srgb{"sRGB", linearFromSrgb};
  if (wanted == ColourSpace::linear) return linear;
  if (wanted == ColourSpace::srgb) return srgb;
  const Decoding byType = spec.format.basesize() == 1 ? srgb : linear;
  const std::string name(spec.get_string_attribute("oiio:ColorSpace"));
  const std::string key = lower(name);
  const double gamma = spec.get_float_attribute("oiio:Gamma", 0.0f);
  if (key.empty()) return byType;
  if (key == "srgb" || key == "srgb_texture" || key == "srgb_tx") return srgb;
  if (key == "linear" || key == "scene_linear" || key == "raw" || key == "data" ||
      key.rfind("lin_", 0) == 0)
    return linear;
  if (key == "rec709") return {"Rec. 709", linearFromRec709};
  if (key.rfind("gamma", 0) == 0) {
    const double stated = std::atof(key.c_str() + 5);
    const double value = stated > 0 ? stated : gamma;
    if (value > 0.1 && value < 10) return gammaDecoding(value);
  }
  notes.push_back(
      fmt::format("its colour space '{}' is not known here; read as {}", name, byType.name));
  return byType;
}

std::uint64_t memoryOf(const OIIO::ImageSpec& spec, const Channels& channels) {
  const std::uint64_t file = std::uint64_t(spec.width) * spec.height;
  const std::uint64_t full = std::uint64_t(spec.full_width) * spec.full_height;
  return file * static_cast<std::uint64_t>(channels.end() - channels.begin()) * sizeof(float) +
         full * 3 * sizeof(float) * 4 / 3;
}

bool stopWhenCancelled(void* opaque, float done) {
  auto* progress = static_cast<Progress*>(opaque);
  if (!progress) return false;
  if (!progress->cancelled()) progress->report("reading the image", done);
  return progress->cancelled();
}

// From the file's pixels, `stride` floats each, to the picture's place in the display window.
class Placing {
 public:
  Placing(const OIIO::ImageSpec& spec, const Channels& channels, const Decoding& decoding)
      : spec_(spec), channels_(channels), decoding_(decoding) {
    first_ = channels.begin();
    stride_ = channels.end() - first_;
    divide_ = channels.alpha >= 0 && spec.get_int_attribute("oiio:UnassociatedAlpha", 0) == 0;
  }

  void row(const std::vector<float>& from, int y, Pixels& to, std::size_t& broken) const {
    const int ty = y + spec_.y - spec_.full_y;
    if (ty < 0 || ty >= to.height) return;
    for (int x = 0; x < spec_.width; ++x) {
      const int tx = x + spec_.x - spec_.full_x;
      if (tx < 0 || tx >= to.width) continue;
      const float* p = &from[(std::size_t(y) * spec_.width + x) * stride_];
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
  const OIIO::ImageSpec& spec_;
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
  const Input input = open(path);
  return memoryOf(input->spec(), channelsOf(path, input->spec()));
}

ImageFile readImage(const std::string& path, const ImageSettings& settings) {
  const Input input = open(path);
  const OIIO::ImageSpec spec = input->spec();
  const Channels channels = channelsOf(path, spec);
  requireMemory("the image " + path, memoryOf(spec, channels), settings.maxMemory,
                "make it smaller or raise --max-memory");
  ImageFile out;
  const Decoding decoding = decodingOf(spec, settings.colourSpace, out.notes);
  out.colourSpace = decoding.name;
  const bool grey = channels.colour[0] == channels.colour[1];
  for (int c = 0; c < (grey ? 1 : 3); ++c)
    out.channels +=
        (c ? "," : "") + spec.channelnames[static_cast<std::size_t>(channels.colour[c])];

  const auto stride = static_cast<std::size_t>(channels.end() - channels.begin());
  std::vector<float> raw(std::size_t(spec.width) * spec.height * stride);
  const bool whole = input->read_image(
      0, 0, channels.begin(), channels.end(), OIIO::TypeDesc::FLOAT, raw.data(), OIIO::AutoStride,
      OIIO::AutoStride, OIIO::AutoStride, stopWhenCancelled, settings.progress);
  throwIfCancelled(settings.progress);
  if (!whole || input->has_error())
    throw FileError(path,
                    fmt::format("is damaged or cut short ({})", firstLine(input->geterror())));
  out.pixels.width = spec.full_width;
  out.pixels.height = spec.full_height;
  out.pixels.rgb.assign(std::size_t(3) * spec.full_width * spec.full_height, 0.0f);
  const Placing placing(spec, channels, decoding);
  std::atomic<std::size_t> broken{0};
  parallelBlocks(
      static_cast<std::size_t>(spec.height), 16,
      [&](std::size_t begin, std::size_t end) {
        std::size_t count = 0;
        for (std::size_t y = begin; y < end; ++y)
          placing.row(raw, static_cast<int>(y), out.pixels, count);
        broken += count;
      },
      settings.progress);
  if (broken > 0)
    out.notes.push_back(fmt::format("{} numbers are not finite; taken as 0", broken.load()));
  if (channels.alpha >= 0) out.notes.emplace_back("its alpha channel is left out");
  return out;
}

}  // namespace innermap
