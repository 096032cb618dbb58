#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/io/volume_texture.h"
#include "io/test_files.h"

namespace innermap {
namespace {

using namespace test;
using openvdb::Coord;

// All voxels of the box and one about it: same values, same states.
template <class Grid>
void expectSame(const Grid& a, const Grid& b, double tolerance = 0) {
  openvdb::CoordBBox box = a.evalActiveVoxelBoundingBox();
  EXPECT_EQ(box, b.evalActiveVoxelBoundingBox());
  box.expand(1);
  const auto x = a.getConstAccessor(), y = b.getConstAccessor();
  int different = 0;
  for (auto at = box.begin(); at != box.end(); ++at) {
    bool same = x.isValueOn(*at) == y.isValueOn(*at);
    if constexpr (openvdb::VecTraits<typename Grid::ValueType>::IsVec)
      same = same && x.getValue(*at).eq(y.getValue(*at),
                                        static_cast<decltype(x.getValue(*at)[0])>(tolerance));
    else
      same = same && std::abs(double(x.getValue(*at)) - double(y.getValue(*at))) <= tolerance;
    different += !same;
  }
  EXPECT_EQ(different, 0) << a.getName();
  EXPECT_EQ(a.getName(), b.getName());
  EXPECT_EQ(a.getGridClass(), b.getGridClass());
  EXPECT_EQ(a.getVectorType(), b.getVectorType());
  EXPECT_EQ(a.constTransform(), b.constTransform());
  EXPECT_EQ(a.valueType(), b.valueType());
}

// A box of values with a hole and a far voxel, so that there are inactive ones.
template <class Grid, class Fill>
typename Grid::Ptr holed(const std::string& name, const Fill& fill) {
  auto grid = block<Grid>(name, kBox, fill, 0.5);
  for (int i = 0; i < 40; ++i) grid->tree().setValueOff(kBox.min().offsetBy(i % 18, i % 7, i % 12));
  grid->tree().setValueOn(Coord(20, 12, 50), fill(Coord(20, 12, 50)));
  for (auto v = grid->beginValueOff(); v; ++v) v.setValue(grid->background());
  return grid;
}

openvdb::GridPtrVec oneOfEachType() {
  openvdb::initialize();
  const auto n = [](const Coord& c) { return c.x() + 50 * c.y() + 3 * c.z() + 1000; };
  openvdb::GridPtrVec grids{
      holed<openvdb::FloatGrid>("float", [&](auto c) { return 0.37f * float(n(c)); }),
      holed<openvdb::DoubleGrid>("double", [&](auto c) { return 0.5 * n(c); }),
      holed<openvdb::Int32Grid>("int", [&](auto c) { return -n(c); }),
      holed<openvdb::Int64Grid>("long", [&](auto c) { return std::int64_t(n(c)); }),
      holed<openvdb::BoolGrid>("bool", [](auto) { return true; }),
      holed<openvdb::Vec3SGrid>("vec", [&](auto c) { return openvdb::Vec3f(float(n(c)), 1, -2); }),
      holed<openvdb::Vec3DGrid>("vecd", [&](auto c) { return openvdb::Vec3d(n(c), 0.5, 0.25); }),
      holed<openvdb::Vec3IGrid>("veci", [&](auto c) { return openvdb::Vec3i(n(c), 1, 2); })};
  grids[0]->setGridClass(openvdb::GRID_FOG_VOLUME);
  grids[5]->setVectorType(openvdb::VEC_CONTRAVARIANT_ABSOLUTE);
  auto mask = openvdb::MaskGrid::create();
  mask->setName("mask");
  mask->topologyUnion(static_cast<const openvdb::FloatGrid&>(*grids[0]));
  mask->setTransform(grids[0]->transform().copy());
  grids.push_back(mask);
  return grids;
}

template <class Grid>
void expectSameAs(const openvdb::GridBase& a, const openvdb::GridBase& b, double tolerance = 0) {
  if (!a.isType<Grid>()) return;
  ASSERT_TRUE(b.isType<Grid>()) << a.getName();
  expectSame(static_cast<const Grid&>(a), static_cast<const Grid&>(b), tolerance);
}

void expectSameGrids(const openvdb::GridPtrVec& a, const openvdb::GridPtrVec& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    expectSameAs<openvdb::FloatGrid>(*a[i], *b[i]);
    expectSameAs<openvdb::DoubleGrid>(*a[i], *b[i]);
    expectSameAs<openvdb::Int32Grid>(*a[i], *b[i]);
    expectSameAs<openvdb::Int64Grid>(*a[i], *b[i]);
    expectSameAs<openvdb::BoolGrid>(*a[i], *b[i]);
    expectSameAs<openvdb::MaskGrid>(*a[i], *b[i]);
    expectSameAs<openvdb::Vec3SGrid>(*a[i], *b[i]);
    expectSameAs<openvdb::Vec3DGrid>(*a[i], *b[i]);
    expectSameAs<openvdb::Vec3IGrid>(*a[i], *b[i]);
  }
}

TEST(VolumeTextureRead, EveryTypeComesBackFromEveryLayout) {
  const openvdb::GridPtrVec grids = oneOfEachType();
  for (const VolumeLayout layout : {VolumeLayout::atlas, VolumeLayout::slices, VolumeLayout::parts})
    for (const int axis : {0, 1, 2}) {
      SCOPED_TRACE(volumeLayoutName(layout) + " " + std::to_string(axis));
      const TemporaryFolder folder;
      VolumeTextureSettings settings{
          .layout = layout, .axis = axis, .rowsUp = axis == 1, .powerOfTwo = axis == 2};
      const auto r = writeVolumeTexture(folder.file("a.exr"), grids, settings);
      const auto back = readVolumeTexture(r.files.front());
      EXPECT_EQ(back.layout, layout);
      EXPECT_EQ(back.resolution, r.resolution);
      EXPECT_EQ(back.notFinite, 0u);
      expectSameGrids(grids, back.grids);
    }
}

TEST(VolumeTextureRead, AnyFileOfTheSlicesOrTheirPatternServes) {
  const TemporaryFolder folder;
  const auto r =
      writeVolumeTexture(folder.file("v2.%03d.exr"), {scalar()}, {.layout = VolumeLayout::slices});
  for (const std::string& path : {r.files[0], r.files[5], folder.file("v2.###.exr")})
    expectSameGrids({scalar()}, readVolumeTexture(path).grids);
  std::filesystem::remove(r.files[5]);
  EXPECT_THROW(readVolumeTexture(r.files[0]), FileError);
  EXPECT_THROW(readVolumeTexture(folder.file("other.###.exr")), FileError);
}

TEST(VolumeTextureRead, LevelSetsKeepTheirSigns) {
  const TemporaryFolder folder;
  const auto surface = ball(20, {3.3, 2, 1}, 0.25);
  VolumeTextureSettings settings;
  for (const bool asHalf : {false, true}) {
    settings.half = asHalf;
    settings.pad = 2;
    writeVolumeTexture(folder.file("a.exr"), {surface}, settings);
    const auto back = readVolumeTexture(folder.file("a.exr")).grids;
    const auto& grid = dynamic_cast<const openvdb::FloatGrid&>(*back[0]);
    expectSame(*surface, grid, asHalf ? 3 * 0.25 / 2048 : 0);
    EXPECT_LT(grid.tree().getValue(Coord(3, 2, 1)), -0.7f);
    EXPECT_FALSE(grid.tree().isValueOn(Coord(3, 2, 1)));
    EXPECT_LT(grid.memUsage(), 2 * surface->memUsage());
  }
}

TEST(VolumeTextureRead, HalfFloatsAreWithinTheirRounding) {
  openvdb::initialize();
  const TemporaryFolder folder;
  auto grid = openvdb::FloatGrid::create(0.1f);  // not a half float
  grid->setName("v");
  for (int i = 0; i < 200; ++i)
    grid->tree().setValue(Coord(i, i % 3, 0), 0.5f + float(std::sin(i)) / 3);
  writeVolumeTexture(folder.file("a.exr"), {grid}, {.half = true});
  const auto back = readVolumeTexture(folder.file("a.exr")).grids;
  const auto& read = dynamic_cast<const openvdb::FloatGrid&>(*back[0]);
  EXPECT_EQ(read.background(), 0.1f);
  expectSame(*grid, read, 1.0 / 2048);
}

TEST(VolumeTextureRead, ActiveChannelTellsBackgroundValuesApart) {
  const TemporaryFolder folder;
  auto grid = scalar();
  grid->tree().setValueOn(kBox.min(), 0.0f);
  grid->tree().setValueOff(kBox.min().offsetBy(1, 1, 1), 0.0f);
  writeVolumeTexture(folder.file("a.exr"), {grid}, {});
  auto back = readVolumeTexture(folder.file("a.exr")).grids;
  EXPECT_EQ(back[0]->activeVoxelCount() + 1, grid->activeVoxelCount());
  writeVolumeTexture(folder.file("a.exr"), {grid}, {.active = true});
  back = readVolumeTexture(folder.file("a.exr")).grids;
  expectSameGrids({grid}, back);
}

TEST(VolumeTextureRead, UniformBlocksAreTiles) {
  openvdb::initialize();
  const TemporaryFolder folder;
  auto grid = openvdb::FloatGrid::create();
  grid->setName("v");
  grid->fill(openvdb::CoordBBox(Coord(0), Coord(63)), 2.0f, true);
  writeVolumeTexture(folder.file("a.exr"), {grid});
  const auto back = readVolumeTexture(folder.file("a.exr")).grids;
  expectSameGrids({grid}, back);
  EXPECT_EQ(dynamic_cast<const openvdb::FloatGrid&>(*back[0]).tree().leafCount(), 0u);
}

// Pixels of a file of one part, to another with the header changed.
void rewrite(const std::string& from, const std::string& to,
             const std::function<void(Imf::Header&)>& change) {
  Imf::InputFile in(from.c_str());
  Imf::Header header = in.header();
  const Imath::Box2i window = header.dataWindow();
  const auto width = std::size_t(window.max.x + 1), height = std::size_t(window.max.y + 1);
  std::vector<std::vector<float>> values;
  Imf::FrameBuffer buffer;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    values.emplace_back(width * height);
    buffer.insert(c.name(), Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.back().data()),
                                       sizeof(float), sizeof(float) * width));
  }
  in.setFrameBuffer(buffer);
  in.readPixels(0, window.max.y);
  change(header);
  Imf::OutputFile out(to.c_str(), header);
  out.setFrameBuffer(buffer);
  out.writePixels(window.max.y + 1);
}

// Imf::Header::erase leaks the attribute (OpenEXR 3.1), so a header is copied without them instead.
void eraseIf(Imf::Header& header, const std::function<bool(const std::string&)>& unwanted) {
  Imf::Header kept(header.displayWindow(), header.dataWindow());
  for (auto a = header.begin(); a != header.end(); ++a)
    if (!unwanted(a.name())) kept.insert(a.name(), a.attribute());
  header = kept;
}

void eraseAll(Imf::Header& header) {
  eraseIf(header, [](const std::string& name) {
    return name.rfind("volume", 0) == 0 || name.rfind("grid", 0) == 0 || name == "indexToWorld" ||
           name == "textureToWorld";
  });
}

std::string errorOf(const std::string& path, const VolumeTextureReadSettings& settings = {}) {
  return test::refusalOf<FileError>([&] { readVolumeTexture(path, settings); });
}

TEST(VolumeTextureRead, OthersAtlasesNeedOptions) {
  const TemporaryFolder folder;
  const std::string path = folder.file("b.exr");
  const auto r = writeVolumeTexture(folder.file("a.exr"), {scalar()});
  rewrite(folder.file("a.exr"), path, eraseAll);
  VolumeTextureReadSettings settings;
  const auto says = [&](const std::string& attribute, const std::string& option) {
    const std::string error = errorOf(path, settings);
    EXPECT_NE(error.find("'" + attribute + "'"), std::string::npos) << error;
    EXPECT_NE(error.find(option), std::string::npos) << error;
  };
  says("volumeTiles", "--tiles");
  settings.tiles = {r.tileColumns, r.tileRows};
  says("indexToWorld", "--voxel-size");
  settings.voxelSize = 0.5;
  settings.lowerCorner = {-2.75, 0.75, 14.75};
  says("gridCount", "--grids");
  settings.names = {"v", "w"};
  EXPECT_NE(errorOf(path, settings).find("--grids"), std::string::npos);
  settings.names = {"v"};
  settings.slices = 12;
  settings.gridClass = "fog volume";
  const auto back = readVolumeTexture(path, settings).grids;
  ASSERT_EQ(back.size(), 1u);
  const auto& grid = dynamic_cast<const openvdb::FloatGrid&>(*back[0]);
  EXPECT_EQ(grid.getGridClass(), openvdb::GRID_FOG_VOLUME);
  EXPECT_EQ(grid.tree().getValue(Coord(3, 2, 1)),
            scalar()->tree().getValue(kBox.min() + Coord(3, 2, 1)));
  EXPECT_LT((grid.indexToWorld(Coord(0)) - scalar()->indexToWorld(kBox.min())).length(), 1e-12);
}

TEST(VolumeTextureRead, AttributesThatContradictAreRefused) {
  const TemporaryFolder folder;
  const std::string good = folder.file("a.exr"), bad = folder.file("b.exr");
  writeVolumeTexture(good, {scalar()});
  const auto refused = [&](const std::string& attribute, const auto& value) {
    rewrite(good, bad, [&](Imf::Header& header) {
      eraseIf(header, [&](const std::string& name) { return name == attribute; });
      header.insert(attribute, value);
    });
    const std::string error = errorOf(bad);
    EXPECT_EQ(error.rfind(bad, 0), 0u) << attribute << ": " << error;
    return error;
  };
  using Imf::IntAttribute, Imf::StringAttribute, Imf::V2iAttribute, Imf::V3iAttribute;
  for (const Imath::V2i& tiles : {Imath::V2i(5, 1), Imath::V2i(0, 3), Imath::V2i(-1, -12),
                                  Imath::V2i(1 << 30, 4), Imath::V2i(1, 1)})
    refused("volumeTiles", V2iAttribute(tiles));
  refused("volumeTileSize", V2iAttribute({18, 9}));
  refused("volumeSliceCount", IntAttribute(4000));
  refused("volumeSliceCount", IntAttribute(-1));
  refused("volumeSliceCount", StringAttribute("twelve"));
  refused("volumeResolution", V3iAttribute({18, 8, 11}));
  refused("volumeIndexMin", V3iAttribute({-2147483647, 0, 0}));
  refused("volumeIndexMax", V3iAttribute({0, 0, 0}));
  refused("volumeAxis", StringAttribute("w"));
  refused("volumeRowOrder", StringAttribute("sideways"));
  refused("volumeTileOrder", StringAttribute("column-major"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Imath::M44d m;
  m[1][1] = nan;
  EXPECT_NE(refused("indexToWorld", Imf::M44dAttribute(m)).find("--voxel-size"), std::string::npos);
  m = Imath::M44d();
  m[1][1] = 0;
  refused("indexToWorld", Imf::M44dAttribute(m));
  m = Imath::M44d();
  m[0][3] = 1;
  refused("indexToWorld", Imf::M44dAttribute(m));
  refused("gridCount", IntAttribute(2));
  refused("gridCount", IntAttribute(-2));
  refused("gridCount", IntAttribute(1 << 30));
  refused("grid0.type", StringAttribute("string"));
  refused("grid0.type", StringAttribute("vec3s"));
  EXPECT_NE(refused("grid0.channel", StringAttribute("Q")).find("'Q'"), std::string::npos);
  refused("volumeLayout", StringAttribute("ring"));
}

TEST(VolumeTextureRead, GridsAreChosenByName) {
  const TemporaryFolder folder;
  writeVolumeTexture(folder.file("a.exr"), {scalar("a"), scalar("b")});
  const auto back = readVolumeTexture(folder.file("a.exr"), {.names = {"b"}}).grids;
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(back[0]->getName(), "b");
  const std::string error = errorOf(folder.file("a.exr"), {.names = {"c"}});
  EXPECT_NE(error.find("'c'"), std::string::npos);
  EXPECT_NE(error.find("a, b"), std::string::npos);
}

TEST(VolumeTextureRead, TruncatedAndDamagedFilesAreRefused) {
  const TemporaryFolder folder;
  const std::string bad = folder.file("b.exr");
  for (const VolumeLayout layout : {VolumeLayout::atlas, VolumeLayout::parts}) {
    writeVolumeTexture(folder.file("a.exr"), {scalar()}, {.layout = layout});
    const std::string whole = contents(folder.file("a.exr"));
    for (std::size_t length = 0; length < whole.size(); length += 1 + length / 5) {
      write(bad, whole.substr(0, length));
      EXPECT_NE(errorOf(bad), "accepted") << length;
    }
    // Any byte of the headers may be anything: an error or grids, no crash and no hoard of memory.
    const MemoryLimit limit(processMemory(0) + 50'000'000);
    for (std::size_t at = 4; at < std::min<std::size_t>(whole.size(), 6000); at += 19) {
      std::string broken = whole;
      broken[at] = static_cast<char>(broken[at] ^ 0xA5);
      write(bad, broken);
      test::refusalOf([&] { readVolumeTexture(bad); });
    }
  }
  write(bad, std::string("\x76\x2f\x31\x01\x02\0\0\0a\0string\0\xff\xff\xff\x7f", 21));
  EXPECT_NE(errorOf(bad), "accepted");
  write(bad, "hello");
  EXPECT_NE(errorOf(bad), "accepted");
  EXPECT_NE(errorOf(folder.file("missing.exr")), "accepted");
}

TEST(VolumeTextureRead, MemoryAndCancellingAreMinded) {
  const TemporaryFolder folder;
  writeVolumeTexture(folder.file("a.exr"), {scalar()});
  test::expectOverLimit(1000, [&] { readVolumeTexture(folder.file("a.exr"), {}); });
  test::expectCancels([&] { readVolumeTexture(folder.file("a.exr"), {}); });
}

}  // namespace
}  // namespace innermap
