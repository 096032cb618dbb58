#include <gtest/gtest.h>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/io/pictures.h"
#include "io/test_files.h"

namespace innermap {
namespace {

using test::TemporaryFolder;

// A PPM file of one colour, 4 x 4 pixels.
std::string plain(const std::string& path, const std::string& rgb) {
  std::string pixels;
  for (int i = 0; i < 16; ++i) pixels += rgb;
  test::write(path, "P6\n4 4\n255\n" + pixels);
  return path;
}

const std::string kRed("\xff\0\0", 3), kBlue("\0\0\xff", 3);

void expectColour(const Vec3& c, const Vec3& expected) {
  EXPECT_NEAR(norm(c - expected), 0, 1e-6) << c.x << " " << c.y << " " << c.z;
}

TEST(TextureImages, OneImageIsLookedUpWithItsWrap) {
  const TemporaryFolder folder;
  const std::string path = plain(folder.file("red.ppm"), kRed);
  const TextureImages repeated(path, {});
  expectColour(repeated.at({0.5, 0.5}, {}, {}), {1, 0, 0});
  expectColour(repeated.at({7.5, -3.5}, {2, 0}, {0, 2}), {1, 0, 0});
  EXPECT_EQ(repeated.width(), 4);
  EXPECT_EQ(repeated.height(), 4);
  EXPECT_EQ(repeated.count(), 1u);
  EXPECT_EQ(repeated.channels(), "R,G,B");
  EXPECT_EQ(repeated.colourSpace(), "Rec. 709");  // that of PPM
  expectColour(TextureImages(path, {}, {.wrap = Wrap::black}).at({7.5, 0.5}, {}, {}), {0, 0, 0});
}

TEST(TextureImages, TilesStandSideBySide) {
  const TemporaryFolder folder;
  plain(folder.file("skin.1001.ppm"), kRed);
  plain(folder.file("skin.1012.ppm"), kBlue);
  const std::string path = folder.file("skin.<UDIM>.ppm");
  EXPECT_TRUE(isTiled(path));
  const TextureImages images(path, {{0, 0}, {1, 1}});
  EXPECT_EQ(images.count(), 2u);
  expectColour(images.at({0.5, 0.5}, {}, {}), {1, 0, 0});
  expectColour(images.at({1.5, 1.5}, {}, {}), {0, 0, 1});
  for (const Vec2& none : {Vec2{1.5, 0.5}, Vec2{-0.5, 0.5}, Vec2{0.5, 1e30}})
    expectColour(images.at(none, {}, {}), {0, 0, 0});
  EXPECT_EQ(textureImageMemory(path, {{0, 0}, {1, 1}}),
            2 * textureImageMemory(folder.file("skin.1001.ppm"), {}));
  EXPECT_EQ(textureImageMemory(path, {}), 0u);
  EXPECT_EQ(TextureImages(path, {}).count(), 0u);
}

TEST(TextureImages, MissingFilesAreNamed) {
  const TemporaryFolder folder;
  EXPECT_THROW(TextureImages(folder.file("none.png"), {}), FileError);
  test::expectRefused<FileError>(
      [&] {
        TextureImages(folder.file("skin.<UDIM>.ppm"), {{3, 0}});
      },
      "skin.1004.ppm");
}

}  // namespace
}  // namespace innermap
