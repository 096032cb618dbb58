#include "innermap/io/volume_texture.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "io/test_files.h"

namespace innermap {
namespace {

using namespace test;
using openvdb::Coord;

// A part's channel: rows of a width.
struct Pixels {
  int width = 0, height = 0;
  std::vector<float> values;
  float at(int x, int y) const { return values.at(static_cast<std::size_t>(y * width + x)); }
};

Pixels pixels(const std::string& path, const std::string& channel, int part = 0) {
  Imf::MultiPartInputFile file(path.c_str());
  const Imath::Box2i window = file.header(part).dataWindow();
  Pixels p{window.max.x + 1, window.max.y + 1, {}};
  p.values.assign(static_cast<std::size_t>(p.width * p.height), -1);
  Imf::FrameBuffer buffer;
  buffer.insert(channel, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(p.values.data()),
                                    sizeof(float), sizeof(float) * std::size_t(p.width)));
  Imf::InputPart input(file, part);
  input.setFrameBuffer(buffer);
  input.readPixels(0, p.height - 1);
  return p;
}

template <class Attribute>
auto attribute(const Imf::Header& header, const std::string& name) {
  const auto* found = header.findTypedAttribute<Attribute>(name);
  EXPECT_TRUE(found) << name;
  return found ? found->value() : std::decay_t<decltype(found->value())>();
}

TEST(VolumeTexture, AtlasHasEachVoxelWhereItSays) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  for (const bool up : {false, true}) {
    const auto r = writeVolumeTexture(path, {scalar()}, {.rowsUp = up});
    EXPECT_EQ(r.resolution, Coord(18, 8, 12));
    EXPECT_EQ(r.channels, std::vector<std::string>{"Y"});
    EXPECT_EQ(r.slices, 12);
    EXPECT_GE(r.tileColumns * r.tileRows, 12);
    const Pixels p = pixels(path, "Y");
    ASSERT_EQ(p.width, r.width);
    ASSERT_EQ(p.height, r.height);
    EXPECT_EQ(r.width, 18 * r.tileColumns);
    for (int k = 0; k < 12; ++k)
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 18; ++x) {
          const Coord c = kBox.min().offsetBy(x, up ? 7 - y : y, k);
          ASSERT_EQ(p.at(k % r.tileColumns * 18 + x, k / r.tileColumns * 8 + y), scalarAt(c));
        }
  }
  EXPECT_EQ(folder.count(), 1u);
}

TEST(VolumeTexture, AttributesSayWhatAndWhere) {
  const TemporaryFolder folder;
  const auto grid = vectors("v");
  grid->setVectorType(openvdb::VEC_COVARIANT);
  const auto fog = scalar("density");
  fog->setGridClass(openvdb::GRID_FOG_VOLUME);
  const auto r = writeVolumeTexture(folder.file("a.exr"), {fog, grid}, {.axis = 1, .active = true});
  Imf::MultiPartInputFile file(folder.file("a.exr").c_str());
  const Imf::Header& h = file.header(0);
  EXPECT_EQ(attribute<Imf::StringAttribute>(h, "volumeLayout"), "atlas");
  EXPECT_EQ(attribute<Imf::StringAttribute>(h, "volumeAxis"), "y");
  EXPECT_EQ(attribute<Imf::StringAttribute>(h, "volumeColumnAxis"), "x");
  EXPECT_EQ(attribute<Imf::StringAttribute>(h, "volumeRowAxis"), "z");
  EXPECT_EQ(attribute<Imf::StringAttribute>(h, "volumeRowOrder"), "down");
  EXPECT_EQ(attribute<Imf::StringAttribute>(h, "volumeTileOrder"), "row-major");
  EXPECT_EQ(attribute<Imf::V2iAttribute>(h, "volumeTiles"), Imath::V2i(r.tileColumns, r.tileRows));
  EXPECT_EQ(attribute<Imf::V2iAttribute>(h, "volumeTileSize"), Imath::V2i(18, 12));
  EXPECT_EQ(attribute<Imf::IntAttribute>(h, "volumeSliceCount"), 8);
  EXPECT_EQ(attribute<Imf::V3iAttribute>(h, "volumeResolution"), Imath::V3i(18, 8, 12));
  EXPECT_EQ(attribute<Imf::V3iAttribute>(h, "volumeIndexMin"), Imath::V3i(-5, 2, 30));
  EXPECT_EQ(attribute<Imf::V3iAttribute>(h, "volumeIndexMax"), Imath::V3i(12, 9, 41));
  const auto near = [](const Imath::V3d& a, const Imath::V3d& b) {
    EXPECT_LT((a - b).length(), 1e-12) << a << " " << b;
  };
  near(attribute<Imf::V3dAttribute>(h, "volumeWorldMin"), {-2.75, 0.75, 14.75});
  near(attribute<Imf::V3dAttribute>(h, "volumeWorldMax"), {6.25, 4.75, 20.75});
  near(attribute<Imf::V3dAttribute>(h, "volumeVoxelSize"), {0.5, 0.5, 0.5});
  near(Imath::V3d(3, 4, 5) * attribute<Imf::M44dAttribute>(h, "indexToWorld"), {1.5, 2, 2.5});
  const Imath::M44d texture = attribute<Imf::M44dAttribute>(h, "textureToWorld");
  near(Imath::V3d(0, 0, 0) * texture, {-2.75, 0.75, 14.75});
  near(Imath::V3d(1, 0.5, 0) * texture, {6.25, 2.75, 14.75});
  EXPECT_EQ(attribute<Imf::IntAttribute>(h, "gridCount"), 2);
  EXPECT_EQ(attribute<Imf::StringAttribute>(h, "grid0.name"), "density");
  EXPECT_EQ(attribute<Imf::StringAttribute>(h, "grid0.class"), "fog volume");
  EXPECT_EQ(attribute<Imf::StringAttribute>(h, "grid0.channel"), "A");
  EXPECT_EQ(attribute<Imf::StringAttribute>(h, "grid0.activeChannel"), "density.active");
  EXPECT_EQ(attribute<Imf::StringAttribute>(h, "grid1.type"), "vec3s");
  EXPECT_EQ(attribute<Imf::StringAttribute>(h, "grid1.vectorType"), "covariant");
  EXPECT_EQ(attribute<Imf::StringAttribute>(h, "grid1.channelZ"), "B");
}

TEST(VolumeTexture, ChannelsAreWhatEnginesLookFor) {
  const auto names = [](const openvdb::GridPtrVec& grids, VolumeChannels channels) {
    return planVolumeTexture("a.exr", grids, {.channels = channels}).channels;
  };
  using Names = std::vector<std::string>;
  const auto a = scalar("a"), b = scalar("b"), c = scalar("c"), d = scalar("d");
  const auto colour = vectors("Cd"), v = vectors("v");
  EXPECT_EQ(names({a}, VolumeChannels::automatic), Names{"Y"});
  EXPECT_EQ(names({a, b}, VolumeChannels::automatic), (Names{"R", "G"}));
  EXPECT_EQ(names({a, b, c, d}, VolumeChannels::automatic), (Names{"R", "G", "B", "A"}));
  EXPECT_EQ(names({a, colour}, VolumeChannels::automatic), (Names{"A", "R", "G", "B"}));
  EXPECT_EQ(names({colour, v}, VolumeChannels::automatic),
            (Names{"Cd.R", "Cd.G", "Cd.B", "v.X", "v.Y", "v.Z"}));
  EXPECT_EQ(names({a}, VolumeChannels::layers), Names{"a.V"});
  EXPECT_THROW(names({colour, v}, VolumeChannels::rgba), SettingError);
}

TEST(VolumeTexture, BoxesGrowToCubesAndPowersOfTwo) {
  const auto plan = [](VolumeTextureSettings settings) {
    return planVolumeTexture("a.exr", {scalar()}, settings);
  };
  EXPECT_EQ(plan({.pad = 2}).resolution, Coord(22, 12, 16));
  const auto r = plan({.powerOfTwo = true});
  EXPECT_EQ(r.resolution, Coord(32, 8, 16));
  for (const int n : {r.width, r.height, r.tileColumns, r.tileRows}) EXPECT_EQ(n & (n - 1), 0);
  EXPECT_EQ(r.tileColumns * r.tileRows, 16);
  EXPECT_EQ(plan({.cube = true}).resolution, Coord(18, 18, 18));
  const auto cube = plan({.cube = true, .resolution = 64});
  EXPECT_EQ(cube.resolution, Coord(64, 64, 64));
  EXPECT_EQ(cube.width, 512);
  EXPECT_EQ(cube.height, 512);
  EXPECT_EQ(plan({.cube = false, .resolution = 64}).resolution, Coord(64, 29, 43));
  // The middle stays where it is.
  EXPECT_LT(
      (plan({.cube = false, .resolution = 64}).worldBox.getCenter() - plan({}).worldBox.getCenter())
          .length(),
      1e-12);
  EXPECT_LT((cube.worldBox.getCenter() - plan({}).worldBox.getCenter()).length(), 1e-12);
  EXPECT_EQ(plan({.tiles = std::pair{3, 4}}).width, 54);
  EXPECT_THROW(plan({.tiles = std::pair{3, 3}}), SettingError);
}

TEST(VolumeTexture, BackgroundStandsWhereNothingIsActive) {
  openvdb::initialize();
  const TemporaryFolder folder;
  auto grid = openvdb::FloatGrid::create(7.0f);
  grid->setName("v");
  grid->tree().setValue(Coord(0, 0, 0), 1.0f);
  grid->tree().setValue(Coord(2, 1, 4), 2.0f);
  const auto r = writeVolumeTexture(folder.file("a.exr"), {grid}, {.active = true});
  const Pixels p = pixels(folder.file("a.exr"), "Y");
  EXPECT_EQ(p.at(0, 0), 1.0f);
  EXPECT_EQ(p.at(1, 0), 7.0f);
  EXPECT_EQ(std::count(p.values.begin(), p.values.end(), 7.0f),
            std::ptrdiff_t(r.width) * r.height - 2);
  const Pixels active = pixels(folder.file("a.exr"), "v.active");
  EXPECT_EQ(std::count(active.values.begin(), active.values.end(), 1.0f), 2);
}

TEST(VolumeTexture, ResamplingKeepsLinearFunctionsAndMeans) {
  const TemporaryFolder folder;
  const auto linear = [](const openvdb::Vec3d& w) { return 2 * w.x() - w.y() + 0.5 * w.z() + 3; };
  const openvdb::CoordBBox box(Coord(0, 0, 0), Coord(31, 15, 23));
  auto grid = block<openvdb::DoubleGrid>(
      "v", box, [&](auto c) { return linear(c.asVec3d() * 0.25); }, 0.25);
  for (const int n : {16, 20, 48}) {
    const auto r = writeVolumeTexture(folder.file("p.exr"), {grid},
                                      {.layout = VolumeLayout::parts, .resolution = n});
    EXPECT_EQ(r.resolution.x(), n);
    Imf::MultiPartInputFile file(folder.file("p.exr").c_str());
    ASSERT_EQ(file.parts(), r.slices);
    const Imath::M44d toWorld = attribute<Imf::M44dAttribute>(file.header(0), "indexToWorld");
    const int k = r.slices / 2;  // away from the boundary
    const Pixels p = pixels(folder.file("p.exr"), "Y", k);
    for (int y = 2; y < p.height - 2; ++y)
      for (int x = 2; x < p.width - 2; ++x) {
        const Imath::V3d w = Imath::V3d(x, y, k) * toWorld;
        ASSERT_NEAR(p.at(x, y), linear({w.x, w.y, w.z}), 1e-5);
      }
  }
  // A checkerboard of single voxels at half the resolution is its mean, not one of its colours.
  auto board = block<openvdb::FloatGrid>("board", box,
                                         [](auto c) { return float((c.x() + c.y() + c.z()) & 1); });
  writeVolumeTexture(folder.file("b.exr"), {board}, {.resolution = 8});
  EXPECT_NEAR(pixels(folder.file("b.exr"), "Y").at(3, 2), 0.5, 0.01);
}

TEST(VolumeTexture, ValuesThatPixelsDoNotHoldAreCounted) {
  const TemporaryFolder folder;
  auto grid = block<openvdb::FloatGrid>("v", kBox, [](auto) { return 1.5f; });
  grid->tree().setValue(Coord(0, 4, 35), 1e6f);
  grid->tree().setValue(Coord(1, 4, 35), -1e6f);
  EXPECT_EQ(writeVolumeTexture(folder.file("h.exr"), {grid}, {.half = true}).clamped, 2u);
  const Pixels p = pixels(folder.file("h.exr"), "Y");
  EXPECT_EQ(*std::max_element(p.values.begin(), p.values.end()), 65504.0f);
  Imf::MultiPartInputFile file(folder.file("h.exr").c_str());
  EXPECT_EQ(file.header(0).channels().findChannel("Y")->type, Imf::HALF);
  EXPECT_EQ(writeVolumeTexture(folder.file("h.exr"), {grid}, {.half = false}).clamped, 0u);
  auto ids = block<openvdb::Int32Grid>("id", kBox, [](auto c) { return 1001 * c.x(); });
  ids->tree().setValue(Coord(0, 4, 35), (1 << 24) + 1);
  EXPECT_EQ(writeVolumeTexture(folder.file("i.exr"), {ids}, {.half = false}).inexact, 1u);
  EXPECT_GT(writeVolumeTexture(folder.file("i.exr"), {ids}, {.half = true}).inexact, 1u);
}

TEST(VolumeTexture, SlicesAreNumberedFiles) {
  const TemporaryFolder folder;
  auto r =
      writeVolumeTexture(folder.file("s.##.exr"), {scalar()}, {.layout = VolumeLayout::slices});
  ASSERT_EQ(r.files.size(), 12u);
  EXPECT_EQ(r.files[7], folder.file("s.07.exr"));
  EXPECT_EQ(folder.count(), 12u);
  EXPECT_EQ(pixels(r.files[7], "Y").at(3, 2), scalarAt(kBox.min().offsetBy(3, 2, 7)));
  r = writeVolumeTexture(folder.file("t.exr"), {scalar()}, {.layout = VolumeLayout::slices});
  EXPECT_EQ(r.files[11], folder.file("t.0011.exr"));
}

TEST(VolumeTexture, RefusesBeforeItWrites) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  VolumeTextureSettings settings;
  test::expectOverLimit(100, [&] { writeVolumeTexture(path, {scalar()}, settings); });
  EXPECT_GT(volumeTextureMemory("a.exr", {scalar()}, {}), 18u * 8 * 12 * 4);
  settings = {};
  settings.resolution = -1;
  EXPECT_THROW(writeVolumeTexture(path, {scalar()}, settings), SettingError);
  EXPECT_THROW(writeVolumeTexture(path, {}, {}), DataError);
  EXPECT_THROW(writeVolumeTexture(path, {openvdb::FloatGrid::create()}, {}), DataError);
  EXPECT_THROW(
      writeVolumeTexture(path, {scalar("a"), scalar("a")}, {.channels = VolumeChannels::layers}),
      DataError);
  auto other = scalar("other");
  other->setTransform(openvdb::math::Transform::createLinearTransform(2));
  EXPECT_THROW(writeVolumeTexture(path, {scalar(), other}, {}), DataError);
  for (const VolumeLayout layout :
       {VolumeLayout::atlas, VolumeLayout::slices, VolumeLayout::parts}) {
    settings = {};
    settings.layout = layout;
    test::expectCancels([&] { writeVolumeTexture(path, {scalar()}, settings); });
  }
  EXPECT_EQ(folder.count(), 0u);
}

TEST(VolumeTexture, NoticesAFullDisk) {
  for (const VolumeLayout layout :
       {VolumeLayout::atlas, VolumeLayout::slices, VolumeLayout::parts}) {
    const TemporaryFolder folder;
    const auto r = writeVolumeTexture(folder.file("s.exr"), {scalar()}, {.layout = layout});
    const auto size = static_cast<rlim_t>(std::filesystem::file_size(r.files.front()));
    for (const rlim_t limit : {rlim_t(0), size / 2, size - 1}) {
      SCOPED_TRACE(limit);
      {
        const test::FullDisk disk(limit);
        EXPECT_THROW(writeVolumeTexture(folder.file("t.exr"), {scalar()}, {.layout = layout}),
                     FileError);
      }
      EXPECT_EQ(folder.count(), r.files.size());
    }
  }
}

TEST(VolumeTexture, IsDescribedAndDoubted) {
  VolumeTextureResult r{.width = 20000};
  r.height = r.tileWidth = r.tileHeight = 8;
  r.slices = 4;
  r.channels = {"R", "G"};
  r.clamped = 3;
  VolumeTextureSettings settings{.half = true};
  const std::string text = describe(r, "a.exr", settings);
  EXPECT_NE(text.find("a.exr: 1 x 1 tiles of 8 x 8, 20000 x 8 pixels\n4 slices along z"),
            std::string::npos)
      << text;
  const std::vector<std::string> warnings = warningsOf(r, "a.exr", settings);
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[0].find("3 values"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[1].find("--resolution"), std::string::npos) << warnings[1];
  r.width = 8;
  r.clamped = 0;
  EXPECT_TRUE(warningsOf(r, "a.exr", settings).empty());
}

}  // namespace
}  // namespace innermap
