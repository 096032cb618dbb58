#include <OpenImageIO/imagebuf.h>
#include <gtest/gtest.h>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/io/pictures.h"
#include "io/test_files.h"

namespace innermap {
namespace {

using namespace test;

// A ball whose value grows along x from -1 to 1 inside, with a skin of 2 voxels.
openvdb::GridPtrVec scene(double voxel = 0.1) {
  const auto surface = ball(20, openvdb::Vec3d(0, 0, 0), voxel);
  const auto jacobian = openvdb::FloatGrid::create();
  jacobian->setName("jacobian");
  jacobian->setTransform(surface->transform().copy());
  const openvdb::CoordBBox box(openvdb::Coord(-22), openvdb::Coord(22));
  for (auto at = box.begin(); at != box.end(); ++at)
    if ((*at).asVec3d().length() <= 22)
      jacobian->tree().setValue(*at, static_cast<float>((*at).x() / 20.0));
  return {surface, jacobian};
}

struct Colour {
  float r, g, b;
};

class Image {
 public:
  explicit Image(const std::string& path) : buffer_(path) { buffer_.read(0, 0, true); }
  int width() const { return buffer_.spec().width; }
  int height() const { return buffer_.spec().height; }
  Colour at(int x, int y) const {
    float c[4] = {};
    buffer_.getpixel(x, y, c, 3);
    return {c[0], c[1], c[2]};
  }

 private:
  OIIO::ImageBuf buffer_;
};

TEST(SectionImage, BlueIsLeastRedIsMostAndOutsideIsGrey) {
  const TemporaryFolder folder;
  const openvdb::GridPtrVec grids = scene();
  for (const auto& grid : grids)
    if (grid->getName() == "jacobian") grid->setName("values");
  const SectionResult r =
      writeSectionImage(folder.file("s.png"), grids, {.grid = "values", .pixels = 450});
  EXPECT_EQ(r.grid, "values");
  EXPECT_NEAR(r.position, 0, 1e-9);
  EXPECT_NEAR(r.least, -0.95, 0.051);
  EXPECT_NEAR(r.most, 0.95, 0.051);
  const Image image(folder.file("s.png"));
  ASSERT_EQ(image.width(), r.width);
  ASSERT_EQ(image.height(), r.height);
  // 47 voxels of the level set's band across 450 pixels, in the middle of a field 480 wide.
  const int cx = 28 + 240, cy = 78 + 225;
  const int radius = 18 * 450 / 47;
  const Colour left = image.at(cx - radius, cy), right = image.at(cx + radius, cy),
               middle = image.at(cx, cy), corner = image.at(35, 85);
  EXPECT_GT(left.b, left.r + 0.2);
  EXPECT_GT(right.r, right.b + 0.4);
  EXPECT_GT(middle.g, 0.85);
  EXPECT_NEAR(corner.r, corner.b, 0.03);
  EXPECT_GT(corner.r, 0.85);
  EXPECT_EQ(folder.count(), 1u);
}

TEST(SectionImage, WhatAJacobianFoldsHasAColourOfItsOwn) {
  const TemporaryFolder folder;
  const SectionResult r = writeSectionImage(folder.file("s.png"), scene(), {.pixels = 450});
  EXPECT_EQ(r.grid, "jacobian");
  EXPECT_NEAR(r.lower * r.upper, 1, 1e-9);
  const Image image(folder.file("s.png"));
  const int cx = 28 + 240, cy = 78 + 225, radius = 18 * 450 / 47;
  const Colour folded = image.at(cx - radius, cy), shrunk = image.at(cx + radius, cy);
  EXPECT_LT(folded.g, 0.1);
  EXPECT_GT(folded.r, 0.7);
  EXPECT_GT(folded.b, 0.65);
  EXPECT_GT(shrunk.g, 0.6);  // 0.75 of the volume: near the pale middle
}

TEST(SectionImage, PlaceAndRangeCanBeGiven) {
  const TemporaryFolder folder;
  SectionSettings settings{.axis = 0};
  settings.position = 1.05;  // between two layers
  settings.range = {{-2, 2}};
  settings.pixels = 200;
  const SectionResult r = writeSectionImage(folder.file("s.png"), scene(), settings);
  EXPECT_NEAR(r.position, 1.05, 1e-9);
  EXPECT_NEAR(r.least, 0.525, 1e-5);
  EXPECT_NEAR(r.most, 0.525, 1e-5);
  EXPECT_EQ(r.lower, -2);
  EXPECT_EQ(r.upper, 2);
}

TEST(SectionImage, ConstantsVectorsAndNaNsWork) {
  const TemporaryFolder folder;
  const openvdb::CoordBBox box(openvdb::Coord(0), openvdb::Coord(9));
  const auto constant = block<openvdb::FloatGrid>("c", box, [](auto) { return 5.0f; });
  SectionResult r = writeSectionImage(folder.file("c.png"), {constant}, {.pixels = 100});
  EXPECT_LT(r.lower, 5);
  EXPECT_GT(r.upper, 5);
  const auto zero = block<openvdb::FloatGrid>("c", box, [](auto) { return 0.0f; });
  r = writeSectionImage(folder.file("z.png"), {zero}, {.pixels = 100});
  EXPECT_LT(r.lower, r.upper);
  const auto map = block<openvdb::Vec3SGrid>(
      "map", box, [](auto c) { return openvdb::Vec3f(3 * c.x(), 4 * c.x(), c.z()); });
  r = writeSectionImage(folder.file("m.png"), {map}, {.component = Component::y, .pixels = 100});
  EXPECT_EQ(r.most, 36);
  r = writeSectionImage(folder.file("m.png"), {map},
                        {.component = Component::length, .at = 0, .pixels = 100});
  EXPECT_EQ(r.most, 45);
  const auto bad = block<openvdb::FloatGrid>(
      "c", box, [](auto c) { return c.x() % 2 ? std::nanf("") : float(c.x()); });
  r = writeSectionImage(folder.file("n.png"), {bad},
                        {.component = Component::length, .at = 0, .pixels = 100});
  EXPECT_EQ(r.most, 8);
}

TEST(SectionImage, ColoursAreShownAsTheyAre) {
  const TemporaryFolder folder;
  openvdb::GridPtrVec grids = scene();
  // Linear 0.5, 0.2140 and, on the right, 2: over white.
  const auto colour = block<openvdb::Vec3SGrid>(
      "Cd", openvdb::CoordBBox(openvdb::Coord(-22), openvdb::Coord(22)),
      [](auto c) { return openvdb::Vec3f(0.5f, 0.2140f, c.x() > 8 ? 2.0f : 0.0f); });
  colour->setTransform(grids[0]->transform().copy());
  grids.push_back(colour);
  SectionSettings settings;
  settings.pixels = 450;
  settings.colour = true;
  SectionResult r = writeSectionImage(folder.file("s.png"), grids, settings);
  EXPECT_EQ(r.grid, "Cd");
  EXPECT_EQ(r.lower, 0);
  EXPECT_EQ(r.upper, 1);
  const Image image(folder.file("s.png"));
  const int cx = image.width() / 2, cy = 78 + 225;
  const Colour middle = image.at(cx - 50, cy), right = image.at(cx + 150, cy);
  EXPECT_NEAR(middle.r, 0.7354, 0.003);
  EXPECT_NEAR(middle.g, 0.5, 0.003);
  EXPECT_NEAR(middle.b, 0, 0.003);
  EXPECT_NEAR(right.b, 1, 0.003);
  settings.range = {{0, 2}};
  r = writeSectionImage(folder.file("s.png"), grids, settings);
  EXPECT_NEAR(Image(folder.file("s.png")).at(cx - 50, cy).r, 0.5371, 0.003);
  settings.grid = "jacobian";
  EXPECT_THROW(writeSectionImage(folder.file("t.png"), grids, settings), DataError);
  EXPECT_EQ(folder.count(), 1u);
}

TEST(SectionImage, RefusesWithAReason) {
  const TemporaryFolder folder;
  const auto grids = scene();
  const std::string path = folder.file("s.png");
  SectionSettings settings{.grid = "curl"};
  EXPECT_THROW(writeSectionImage(path, grids, settings), DataError);
  settings = {};
  settings.at = 1.5;
  EXPECT_THROW(writeSectionImage(path, grids, settings), SettingError);
  settings = {};
  settings.position = 100;
  EXPECT_THROW(writeSectionImage(path, grids, settings), SettingError);
  settings = {};
  settings.range = {{1, 1}};
  EXPECT_THROW(writeSectionImage(path, grids, settings), SettingError);
  settings = {};
  settings.at = 0;  // the band outside the solid
  EXPECT_THROW(writeSectionImage(path, grids, settings), DataError);
  settings = {};
  test::expectOverLimit(1000, [&] { writeSectionImage(path, grids, settings); });
  EXPECT_THROW(writeSectionImage(folder.file("no/s.png"), grids, {}), FileError);
  EXPECT_EQ(folder.count(), 0u);
}

}  // namespace
}  // namespace innermap
