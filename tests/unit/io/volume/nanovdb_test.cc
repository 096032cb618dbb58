// What is written as NanoVDB, read by NanoVDB's own reader and looked at by its own validator.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "innermap/core/error.h"
#include "innermap/io/volume_texture.h"
#include "io/test_files.h"

#define NANOVDB_USE_ZIP
#include <nanovdb/util/GridValidator.h>
#include <nanovdb/util/IO.h>

namespace innermap {
namespace {

using namespace test;
using openvdb::Coord;

openvdb::FloatGrid::Ptr density() {
  auto grid = block<openvdb::FloatGrid>(
      "density", kBox, [](Coord c) { return float(c.x()) + 0.125f * float(c.z()); }, 0.5);
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  grid->tree().addTile(1, Coord(64, 0, 0), 7.5f, true);
  return grid;
}

using Handles = std::vector<nanovdb::GridHandle<nanovdb::HostBuffer>>;

Handles readBack(const std::string& path) { return nanovdb::io::readGrids(path); }

// The grid of that number, valid by NanoVDB's own checks (with the checksum over all bytes).
template <class Type>
const nanovdb::NanoGrid<Type>& valid(const Handles& handles, std::size_t i,
                                     const std::string& name) {
  const auto* grid = handles.at(i).template grid<Type>();
  if (!grid) throw DataError("another type");
  EXPECT_EQ(nanovdb::GridValidator<Type>::check(*grid, true), "");
  EXPECT_EQ(grid->gridName(), name);
  return *grid;
}

// Both grids in a box that is larger than what is active: largest difference of values; states
// alike.
template <class Nano, class Open>
double difference(const Nano& nano, const Open& open) {
  const auto one = nano.getAccessor();
  const auto other = open.getConstAccessor();
  double most = 0;
  openvdb::CoordBBox box = open.evalActiveVoxelBoundingBox();
  box.expand(2);
  for (auto at = box.begin(); at != box.end(); ++at) {
    const nanovdb::Coord c((*at).x(), (*at).y(), (*at).z());
    if (one.isActive(c) != other.isValueOn(*at)) return 1e30;
    const auto a = one.getValue(c);
    const auto b = other.getValue(*at);
    if constexpr (openvdb::VecTraits<typename Open::ValueType>::IsVec)
      for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(double(a[k]) - double(b[k])));
    else
      most = std::max(most, std::abs(double(a) - double(b)));
  }
  return most;
}

TEST(NanoVdb, HoldsValuesStatesNamesClassesAndPlaces) {
  const TemporaryFolder folder;
  const auto fog = density();
  const auto surface = ball(6, {3, 4, 5}, 0.25);
  const auto velocity = vectors<openvdb::Vec3SGrid>("v");
  for (const bool zip : {false, true}) {
    const std::string path = folder.file("a.nvdb");
    const auto r = writeVolumeTexture(path, {fog, surface, velocity}, {.zip = zip});
    EXPECT_EQ(r.format, "NanoVDB");
    EXPECT_EQ(r.channels, (std::vector<std::string>{"density", "surface", "v"}));
    const Handles handles = readBack(path);
    ASSERT_EQ(handles.size(), 3u);
    const auto& nanoFog = valid<float>(handles, 0, "density");
    EXPECT_EQ(difference(nanoFog, *fog), 0);
    EXPECT_TRUE(nanoFog.isFogVolume());
    const auto& nanoSurface = valid<float>(handles, 1, "surface");
    EXPECT_EQ(difference(nanoSurface, *surface), 0);
    EXPECT_TRUE(nanoSurface.isLevelSet());
    EXPECT_EQ(nanoSurface.tree().background(), surface->background());
    EXPECT_EQ(difference(valid<nanovdb::Vec3f>(handles, 2, "v"), *velocity), 0);
    const auto world = nanoSurface.indexToWorld(nanovdb::Vec3d(3, -4, 5));
    const auto expected = surface->indexToWorld(openvdb::Vec3d(3, -4, 5));
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(world[k], expected[k], 1e-12);
  }
}

TEST(NanoVdb, OtherTypesBecomeThoseOfReaders) {
  const TemporaryFolder folder;
  const auto number = [](auto c) { return c.x() + 100 * c.y(); };
  const auto doubles = block<openvdb::DoubleGrid>("d", kBox, number);
  const auto labels =
      block<openvdb::Int32Grid>("label", kBox, [&](auto c) { return 614454277 + number(c); });
  const auto large = block<openvdb::Int64Grid>(
      "large", kBox, [&](auto c) { return (std::int64_t(1) << 60) + number(c); });
  const auto flags = block<openvdb::BoolGrid>("flag", kBox, [](auto c) { return c.x() % 2 == 0; });
  const auto mask = block<openvdb::MaskGrid>("mask", kBox, [](auto) { return true; });
  const auto places = vectors<openvdb::Vec3DGrid>("p");
  const auto cells = vectors<openvdb::Vec3IGrid>("ijk");
  const std::string path = folder.file("a.nvdb");
  writeVolumeTexture(path, {doubles, labels, large, flags, mask, places, cells});
  const Handles h = readBack(path);
  ASSERT_EQ(h.size(), 7u);
  EXPECT_EQ(difference(valid<float>(h, 0, "d"), *doubles), 0);
  EXPECT_EQ(difference(valid<std::int32_t>(h, 1, "label"), *labels), 0);
  EXPECT_EQ(difference(valid<std::int64_t>(h, 2, "large"), *large), 0);
  EXPECT_EQ(difference(valid<bool>(h, 3, "flag"), *flags), 0);
  EXPECT_EQ(difference(valid<nanovdb::ValueMask>(h, 4, "mask"), *mask), 0);
  EXPECT_EQ(difference(valid<nanovdb::Vec3f>(h, 5, "p"), *places), 0);
  EXPECT_EQ(difference(valid<nanovdb::Vec3f>(h, 6, "ijk"), *cells), 0);
}

TEST(NanoVdb, HalfIsSixteenBitsOfEachLeafsSpan) {
  const TemporaryFolder folder;
  const auto fog = density();
  writeVolumeTexture(folder.file("f.nvdb"), {fog}, {});
  writeVolumeTexture(folder.file("h.nvdb"), {fog, vectors<openvdb::Vec3SGrid>("v")},
                     {.half = true});
  const Handles h = readBack(folder.file("h.nvdb"));
  // Over the whole grid the values span 19 and more.
  EXPECT_LT(difference(valid<nanovdb::Fp16>(h, 0, "density"), *fog), 19.0 / 65535);
  EXPECT_EQ(difference(valid<nanovdb::Vec3f>(h, 1, "v"), *vectors<openvdb::Vec3SGrid>("v")), 0);
  const auto bytes = [&](const std::string& path) { return readBack(path).front().size(); };
  EXPECT_LT(bytes(folder.file("h.nvdb")), bytes(folder.file("f.nvdb")));
}

TEST(NanoVdb, SameBytesEachTime) {
  const TemporaryFolder folder;
  const auto bytes = [&](const std::string& name) {
    writeVolumeTexture(folder.file(name), {density(), vectors<openvdb::Vec3SGrid>("v")});
    std::ifstream file(folder.file(name), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const std::string first = bytes("a.nvdb");
  EXPECT_GT(first.size(), 1000u);
  EXPECT_TRUE(first == bytes("b.nvdb"));
}

TEST(NanoVdb, RefusesWhatItCannotHold) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.nvdb");
  EXPECT_THROW(writeVolumeTexture(path, {}), DataError);
  EXPECT_THROW(writeVolumeTexture(path, {openvdb::FloatGrid::create()}), DataError);
  EXPECT_THROW(writeVolumeTexture(path, {density(), density()}), DataError);
  const auto empty = openvdb::FloatGrid::create();
  empty->setName("a");
  EXPECT_THROW(writeVolumeTexture(path, {empty}), DataError);
  const auto other = openvdb::Grid<openvdb::UInt32Tree>::create();
  other->setName("a");
  other->tree().setValue(Coord(0), 1);
  EXPECT_THROW(writeVolumeTexture(path, {other}), DataError);
  EXPECT_THROW(writeVolumeTexture(path, {density()}, {.resolution = 16}), SettingError);
  EXPECT_THROW(writeVolumeTexture(path, {density()}, {.tiles = std::pair{1, 12}}), SettingError);
  EXPECT_FALSE(std::ifstream(path).good());
}

}  // namespace
}  // namespace innermap
