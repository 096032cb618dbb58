// A small RGB canvas with text, for the pictures of results.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/io/pictures.h"

namespace innermap {

using Rgb = std::array<float, 3>;  // sRGB, 0..1

constexpr Rgb kPaper{1, 1, 1}, kInk{0.13f, 0.14f, 0.16f};

Rgb rampColour(double t, Colormap map = Colormap::redBlue);

Vec3 linear(const Rgb& colour);  // of sRGB (IEC 61966-2-1)
float encoded(double light);     // to sRGB; what is outside [0, 1], or no number, is clamped

enum class Align { left, centre, right };

class Picture {
 public:
  Picture(int width, int height, Rgb background);

  int width() const { return width_; }
  int height() const { return height_; }

  void set(int x, int y, Rgb colour);                      // outside the picture: nothing
  void blend(int x, int y, Rgb colour, float share);       // over what is there; share 0..1
  void fill(int x0, int y0, int x1, int y1, Rgb colour);   // [x0, x1) x [y0, y1)
  void frame(int x0, int y0, int x1, int y1, Rgb colour);  // one pixel wide, outside the box

  // Text with its baseline at y; nothing where no font is installed (see labelFont).
  void text(int x, int y, const std::string& text, int size, Rgb colour, Align align = Align::left);

  // Writes a PNG, 8 bits; it appears whole or not at all. Throws FileError.
  void write(const std::string& path) const;

 private:
  int width_, height_;
  std::vector<float> pixels_;  // #height * #width * 3
};

// Width of a text in pixels; about that when no font is installed.
int textWidth(const std::string& text, int size);

// About `count` round numbers in [lower, upper].
std::vector<double> tickValues(double lower, double upper, int count);

// A number as short as it can be told: 0.25, 12, 3.1e-07.
std::string shortNumber(double value);

}  // namespace innermap
