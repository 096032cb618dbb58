#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <vector>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/io/pictures.h"
#include "io/test_files.h"

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define INNERMAP_FINDS_LEAKS
#include <sanitizer/lsan_interface.h>
#endif
#endif

namespace innermap {
namespace {

using test::TemporaryFolder;

// What libraries leave behind in a scope is not reported by LeakSanitizer.
#ifdef INNERMAP_FINDS_LEAKS
using IgnoredLeaks = __lsan::ScopedDisabler;
#else
struct IgnoredLeaks {
  IgnoredLeaks() {}
};
#endif

// Every pixel has the same values, but for pixel (0, 0), which has twice them.
void write(const std::string& path, const OIIO::ImageSpec& spec, const std::vector<float>& values) {
  auto out = OIIO::ImageOutput::create(path);
  ASSERT_TRUE(out) << OIIO::geterror();
  std::vector<float> pixels;
  for (int i = 0; i < spec.width * spec.height; ++i)
    for (const float v : values) pixels.push_back(i == 0 ? 2 * v : v);
  ASSERT_TRUE(out->open(path, spec)) << out->geterror();
  ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, pixels.data())) << out->geterror();
  out->close();
}

OIIO::ImageSpec specOf(std::vector<std::string> channels, const OIIO::TypeDesc& type, int width = 5,
                       int height = 3) {
  OIIO::ImageSpec spec(width, height, static_cast<int>(channels.size()), type);
  spec.channelnames = std::move(channels);
  for (int c = 0; c < spec.nchannels; ++c)
    if (spec.channelnames[static_cast<std::size_t>(c)] == "A") spec.alpha_channel = c;
  return spec;
}

void expectPixel(const ImageFile& file, int x, int y, double r, double g, double b,
                 double tolerance) {
  const float* p = &file.pixels.rgb[3 * (static_cast<std::size_t>(y) * file.pixels.width + x)];
  EXPECT_NEAR(p[0], r, tolerance);
  EXPECT_NEAR(p[1], g, tolerance);
  EXPECT_NEAR(p[2], b, tolerance);
}

ImageSettings as(ColourSpace space) { return {.colourSpace = space}; }

TEST(ImageFile, EightBitsAreSrgbAndFloatsLinear) {
  const TemporaryFolder folder;
  const std::vector<float> values{0.5f, 0.25f, 0.125f};
  write(folder.file("a.png"), specOf({"R", "G", "B"}, OIIO::TypeDesc::UINT8), values);
  const ImageFile png = readImage(folder.file("a.png"));
  EXPECT_EQ(png.colourSpace, "sRGB");
  EXPECT_EQ(png.channels, "R,G,B");
  EXPECT_EQ(png.pixels.width, 5);
  EXPECT_EQ(png.pixels.height, 3);
  expectPixel(png, 2, 1, linearFromSrgb(0.5), linearFromSrgb(0.25), linearFromSrgb(0.125), 0.004);
  expectPixel(png, 0, 0, 1, linearFromSrgb(0.5), linearFromSrgb(0.25), 0.004);  // upper left
  write(folder.file("a.exr"), specOf({"R", "G", "B"}, OIIO::TypeDesc::FLOAT), values);
  const ImageFile exr = readImage(folder.file("a.exr"));
  EXPECT_EQ(exr.colourSpace, "linear");
  expectPixel(exr, 2, 1, 0.5, 0.25, 0.125, 1e-6);
  const ImageFile forced = readImage(folder.file("a.exr"), as(ColourSpace::srgb));
  expectPixel(forced, 2, 1, linearFromSrgb(0.5), linearFromSrgb(0.25), linearFromSrgb(0.125), 1e-6);
  const ImageFile raw = readImage(folder.file("a.png"), as(ColourSpace::linear));
  expectPixel(raw, 2, 1, 0.5, 0.25, 0.125, 0.003);
}

TEST(ImageFile, MetadataTellsTheColourSpace) {
  const TemporaryFolder folder;
  OIIO::ImageSpec spec = specOf({"R", "G", "B"}, OIIO::TypeDesc::UINT16);
  spec.attribute("oiio:ColorSpace", "sRGB");
  write(folder.file("s.png"), spec, {0.5f, 0.5f, 0.5f});
  expectPixel(readImage(folder.file("s.png")), 1, 1, linearFromSrgb(0.5), linearFromSrgb(0.5),
              linearFromSrgb(0.5), 1e-4);
  spec = specOf({"R", "G", "B"}, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "linear");
  spec.attribute("oiio:Gamma", 1.0f);
  write(folder.file("l.png"), spec, {0.5f, 0.5f, 0.5f});
  expectPixel(readImage(folder.file("l.png")), 1, 1, 0.5, 0.5, 0.5, 0.003);
  EXPECT_NEAR(linearFromSrgb(0.04), 0.04 / 12.92, 1e-12);
  EXPECT_NEAR(linearFromSrgb(1), 1, 1e-12);
  EXPECT_NEAR(linearFromSrgb(-0.5), -linearFromSrgb(0.5), 1e-12);
}

TEST(ImageFile, GreyAndAlpha) {
  const TemporaryFolder folder;
  write(folder.file("y.exr"), specOf({"Y"}, OIIO::TypeDesc::FLOAT), {0.3f});
  const ImageFile grey = readImage(folder.file("y.exr"));
  EXPECT_EQ(grey.channels, "Y");
  expectPixel(grey, 3, 2, 0.3, 0.3, 0.3, 1e-6);
  // An EXR file's colours are multiplied by alpha: they come out as if it was opaque.
  write(folder.file("a.exr"), specOf({"R", "G", "B", "A"}, OIIO::TypeDesc::FLOAT),
        {0.2f, 0.1f, 0.05f, 0.25f});
  const ImageFile alpha = readImage(folder.file("a.exr"));
  expectPixel(alpha, 3, 2, 0.8, 0.4, 0.2, 1e-6);
  ASSERT_EQ(alpha.notes.size(), 1u);
  EXPECT_NE(alpha.notes[0].find("alpha"), std::string::npos);
  // A PNG file's are not.
  OIIO::ImageSpec spec = specOf({"R", "G", "B", "A"}, OIIO::TypeDesc::UINT16);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  write(folder.file("a.png"), spec, {0.2f, 0.1f, 0.05f, 0.25f});
  expectPixel(readImage(folder.file("a.png"), as(ColourSpace::linear)), 3, 2, 0.2, 0.1, 0.05, 2e-4);
}

TEST(ImageFile, NamesOfLayersAndOtherChannels) {
  const TemporaryFolder folder;
  write(folder.file("l.exr"),
        specOf({"depth.Z", "skin.R", "skin.G", "skin.B", "N.X"}, OIIO::TypeDesc::FLOAT),
        {9, 0.1f, 0.2f, 0.3f, 7});
  const ImageFile layer = readImage(folder.file("l.exr"));
  expectPixel(layer, 1, 1, 0.1, 0.2, 0.3, 1e-6);
  for (const auto& channels : {std::vector<std::string>{"Z"}, std::vector<std::string>{"A"},
                               std::vector<std::string>{"N.X", "N.Y"}}) {
    write(folder.file("z.exr"), specOf(channels, OIIO::TypeDesc::FLOAT),
          std::vector<float>(channels.size(), 1.0f));
    test::expectRefused<FileError>([&] { readImage(folder.file("z.exr")); }, channels[0]);
  }
}

TEST(ImageFile, DataWindowsAndBrokenNumbers) {
  const TemporaryFolder folder;
  OIIO::ImageSpec spec = specOf({"R", "G", "B"}, OIIO::TypeDesc::FLOAT, 4, 2);
  spec.x = 3;
  spec.y = 5;
  spec.full_x = 1;
  spec.full_y = 4;
  spec.full_width = 5;  // the last pixels of each row hang over
  spec.full_height = 6;
  write(folder.file("w.exr"), spec, {0.5f, std::numeric_limits<float>::quiet_NaN(), 0.25f});
  const ImageFile file = readImage(folder.file("w.exr"));
  EXPECT_EQ(file.pixels.width, 5);
  EXPECT_EQ(file.pixels.height, 6);
  expectPixel(file, 1, 1, 0, 0, 0, 1e-9);
  expectPixel(file, 2, 1, 1, 0, 0.5, 1e-6);
  expectPixel(file, 3, 2, 0.5, 0, 0.25, 1e-6);
  expectPixel(file, 3, 3, 0, 0, 0, 1e-9);
  ASSERT_EQ(file.notes.size(), 1u);
}

TEST(ImageFile, BadFiles) {
  const TemporaryFolder folder;
  EXPECT_THROW(readImage(folder.file("missing.png")), FileError);
  EXPECT_THROW(readImage(folder.file("")), FileError);
  for (const char* name : {"text.png", "text.exr", "text.jpg", "text.obj", "text"}) {
    std::ofstream(folder.file(name)) << "not an image at all\n";
    EXPECT_THROW(readImage(folder.file(name)), FileError) << name;
  }
  write(folder.file("a.png"), specOf({"R", "G", "B"}, OIIO::TypeDesc::UINT8, 64, 64), {1, 0, 1});
  write(folder.file("a.exr"), specOf({"R", "G", "B"}, OIIO::TypeDesc::HALF, 64, 64), {1, 0, 1});
  for (const std::string name : {"a.png", "a.exr"}) {
    const std::string whole = test::contents(folder.file(name));
    for (const double share : {0.1, 0.5, 0.9}) {
      const std::string cut = folder.file("cut" + name);
      std::ofstream(cut, std::ios::binary)
          .write(whole.data(),
                 static_cast<std::streamsize>(share * static_cast<double>(whole.size())));
      const IgnoredLeaks libpng;  // its errors jump over OpenImageIO's strings
      EXPECT_THROW(readImage(cut), FileError) << name << " " << share;
    }
  }
}

// What a file begins with counts, and no other format's reader sees it.
TEST(ImageFile, WrongEndings) {
  const TemporaryFolder folder;
  write(folder.file("a.png"), specOf({"R", "G", "B"}, OIIO::TypeDesc::UINT8), {1, 0, 1});
  std::filesystem::rename(folder.file("a.png"), folder.file("a.jpg"));
  EXPECT_EQ(readImage(folder.file("a.jpg")).pixels.width, 5);
  write(folder.file("b.bmp"), specOf({"R", "G", "B"}, OIIO::TypeDesc::UINT8), {1, 0, 1});
  EXPECT_EQ(readImage(folder.file("b.bmp")).pixels.width, 5);
  std::filesystem::rename(folder.file("b.bmp"), folder.file("b.png"));
  EXPECT_THROW(readImage(folder.file("b.png")), FileError);
}

// OpenEXR allocates a tile, whatever the picture's size.
TEST(ImageFile, TilesLargerThanThePicture) {
  const TemporaryFolder folder;
  OIIO::ImageSpec spec = specOf({"R", "G", "B"}, OIIO::TypeDesc::FLOAT, 8, 8);
  spec.tile_width = spec.tile_height = 64;
  auto out = OIIO::ImageOutput::create("openexr");
  ASSERT_TRUE(out->open(folder.file("a.exr"), spec)) << out->geterror();
  ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, std::vector<float>(8 * 8 * 3, 1).data()));
  out->close();
  EXPECT_EQ(readImage(folder.file("a.exr")).pixels.width, 8);
  std::string bytes = test::contents(folder.file("a.exr"));
  const std::string tiles("tiles\0tiledesc\0\11\0\0\0", 19);
  const std::size_t at = bytes.find(tiles);
  ASSERT_NE(at, bytes.npos);
  bytes.replace(at + tiles.size(), 8, std::string("\0\40\0\0\0\40\0\0", 8));  // 8192 x 8192
  test::write(folder.file("a.exr"), bytes);
  EXPECT_THROW(readImage(folder.file("a.exr")), FileError);
}

TEST(ImageFile, MemoryAndCancelling) {
  const TemporaryFolder folder;
  write(folder.file("a.png"), specOf({"R", "G", "B"}, OIIO::TypeDesc::UINT8, 64, 64), {1, 0, 1});
  EXPECT_GE(imageMemory(folder.file("a.png")), 64u * 64 * 12);
  test::expectOverLimit(1000, [&] { readImage(folder.file("a.png"), {}); });
  test::expectCancels([&] { readImage(folder.file("a.png"), {}); });
}

}  // namespace
}  // namespace innermap
