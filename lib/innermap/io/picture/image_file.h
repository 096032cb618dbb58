// Image files, as linear colours.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace innermap {

// How a file's numbers are to be read. automatic: as its metadata says (sRGB, linear, Rec. 709, a
// gamma), else integers of 8 bits as sRGB and all others as linear.
enum class ColourSpace { automatic, linear, srgb };

// What stands beyond the image: the image again, its border, its mirror image, or nothing (black).
enum class Wrap { repeat, clamp, mirror, black };

// The inverse of sRGB's transfer function (IEC 61966-2-1), continued linearly beyond 1 and oddly
// below 0.
double linearFromSrgb(double encoded);

struct ImageSettings {
  ColourSpace colourSpace = ColourSpace::automatic;
};

// Linear colours, rows from the top. #height * #width * 3 floats.
struct Pixels {
  int width = 0, height = 0;
  std::vector<float> rgb;
};

struct ImageFile {
  Pixels pixels;
  std::string colourSpace;         // what the numbers were read as: "sRGB", "linear", ...
  std::string channels;            // that were taken: "R,G,B", "Y"
  std::vector<std::string> notes;  // what was left out or repaired, a line each
};

// Reads any format that OpenImageIO reads: PNG, JPEG, TIFF, EXR and HDR by what the file begins
// with, others by the ending; the first image of a file that has several. Grey images give three
// equal channels. Alpha is left out: colours are those of an opaque surface (where they are
// multiplied by alpha in the file, they are divided by it). Pixels outside an EXR file's data
// window are black. Numbers that are not finite become 0 and are noted. Throws FileError for what
// is missing, damaged or cut short, is no image, is deep or a volume, or has no colour channels (Z
// or alpha alone); MemoryError before allocating; Cancelled.
ImageFile readImage(const std::string& path, const ImageSettings& settings = {});

// Bytes that an image of this size takes with its pyramid while it is read.
std::uint64_t imageMemory(const std::string& path);

}  // namespace innermap
