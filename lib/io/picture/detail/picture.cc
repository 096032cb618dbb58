#include "io/picture/detail/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ostream>

#include "core/file.h"
#include "innermap/core/error.h"
#include "innermap/io/pictures.h"
#include "io/picture/detail/image_library.h"

namespace innermap {
namespace {

std::string printable(const std::string& text) {
  std::string result = text;
  for (char& c : result)
    if (static_cast<unsigned char>(c) < 32) c = ' ';
  return result;
}

}  // namespace

Rgb rampColour(double t, Colormap map) {
  const Vec3 c = colormapColour(map, t);
  return {static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z)};
}

Vec3 linear(const Rgb& colour) {
  Vec3 out;
  for (int c = 0; c < 3; ++c) {
    const double v = static_cast<double>(colour[static_cast<std::size_t>(c)]);
    out[c] = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  }
  return out;
}

float encoded(double light) {
  if (!(light > 0)) return 0;
  if (light >= 1) return 1;
  return static_cast<float>(light <= 0.0031308 ? 12.92 * light
                                               : 1.055 * std::pow(light, 1 / 2.4) - 0.055);
}

Picture::Picture(int width, int height, Rgb background)
    : width_(width), height_(height), pixels_(static_cast<std::size_t>(width) * height * 3) {
  fill(0, 0, width, height, background);
}

void Picture::set(int x, int y, Rgb colour) {
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
  std::copy(colour.begin(), colour.end(),
            pixels_.begin() + (static_cast<std::ptrdiff_t>(y) * width_ + x) * 3);
}

void Picture::blend(int x, int y, Rgb colour, float share) {
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
  float* pixel = pixels_.data() + (static_cast<std::size_t>(y) * width_ + x) * 3;
  for (int c = 0; c < 3; ++c) pixel[c] += share * (colour[c] - pixel[c]);
}

void Picture::fill(int x0, int y0, int x1, int y1, Rgb colour) {
  for (int y = std::max(0, y0); y < std::min(height_, y1); ++y)
    for (int x = std::max(0, x0); x < std::min(width_, x1); ++x) set(x, y, colour);
}

void Picture::frame(int x0, int y0, int x1, int y1, Rgb colour) {
  fill(x0 - 1, y0 - 1, x1 + 1, y0, colour);
  fill(x0 - 1, y1, x1 + 1, y1 + 1, colour);
  fill(x0 - 1, y0, x0, y1, colour);
  fill(x1, y0, x1 + 1, y1, colour);
}

void Picture::text(int x, int y, const std::string& text, int size, Rgb colour, Align align) {
  if (labelFont().empty()) return;
  const std::string line = printable(text);
  if (align != Align::left) {
    const int width = textWidth(line, size);
    x -= align == Align::right ? width : width / 2;
  }
  imageLibrary().drawText(width_, height_, pixels_.data(), x, y, line, size, labelFont(), colour);
}

void Picture::write(const std::string& path) const {
  std::vector<unsigned char> pixels(pixels_.size());
  std::transform(pixels_.begin(), pixels_.end(), pixels.begin(), [](float v) {
    return static_cast<unsigned char>(std::lround(std::clamp(v, 0.0f, 1.0f) * 255));
  });
  std::string why;
  const std::vector<unsigned char> bytes =
      imageLibrary().encodePng(width_, height_, pixels.data(), why);
  if (bytes.empty()) throw FileError(path, "the picture cannot be encoded as PNG (" + why + ")");
  writeWholeFile(path, [&](std::ostream& file) {
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  });
}

int textWidth(const std::string& text, int size) {
  if (!labelFont().empty()) {
    const int width = imageLibrary().textWidth(printable(text), size, labelFont());
    if (width >= 0) return width;
  }
  return static_cast<int>(text.size()) * size * 3 / 5;
}

std::vector<double> tickValues(double lower, double upper, int count) {
  const double span = upper - lower;
  if (!(span > 0) || !std::isfinite(span) || count < 1) return {lower};
  const double raw = span / count, power = std::pow(10.0, std::floor(std::log10(raw)));
  const double multiple = raw / power;
  const double step = power * (multiple < 1.5 ? 1 : multiple < 3.5 ? 2 : multiple < 7.5 ? 5 : 10);
  std::vector<double> ticks;
  const double first = std::ceil(lower / step - 1e-9);
  for (int i = 0; i <= 4 * count; ++i) {
    const double tick = (first + i) * step;
    if (tick > upper + 1e-9 * step) break;
    ticks.push_back(std::abs(tick) < 1e-9 * step ? 0.0 : tick);
  }
  return ticks;
}

std::string shortNumber(double value) { return fmt::format("{:.4g}", value); }

}  // namespace innermap
