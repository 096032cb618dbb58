// NIfTI files: there and back, damaged ones. What other programs read is in
// cli/test_volume_files.py.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <random>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/io/volume_texture.h"
#include "io/test_files.h"

namespace innermap {
namespace {

using namespace test;
using openvdb::Coord;

const openvdb::CoordBBox kSmall(Coord(-5, 2, 30), Coord(4, 9, 41));

openvdb::Int32Grid::Ptr labels() {
  return block<openvdb::Int32Grid>(
      "label", kSmall, [](auto c) { return 614454277 + c.x(); }, 0.5);
}

TEST(Nifti, GridsComeBackWithTypesNamesAndPlaces) {
  const TemporaryFolder folder;
  const auto field = vectors("v", kSmall);
  for (const char* name : {"a.nii", "a.nii.gz"}) {
    const std::string path = folder.file(name);
    for (const openvdb::GridBase::Ptr& grid : openvdb::GridPtrVec{
             labels(), field,
             block<openvdb::DoubleGrid>("d", kSmall, [](auto c) { return 0.1 * c.x(); }),
             block<openvdb::Int64Grid>("far", kSmall,
                                       [](auto c) { return (std::int64_t(1) << 40) + c.x(); })}) {
      writeVolumeTexture(path, {grid});
      const VolumeTextureContents back = readVolumeTexture(path);
      ASSERT_EQ(back.grids.size(), 1u);
      EXPECT_EQ(back.format, "NIfTI");
      EXPECT_EQ(back.grids[0]->getName(), grid->getName());
      EXPECT_EQ(back.grids[0]->valueType(), grid->valueType());
      EXPECT_EQ(back.resolution, kSmall.dim());
      const auto there = grid->indexToWorld(openvdb::Vec3d(-5 + 1, 2 + 2, 30 + 3));
      EXPECT_LT((back.grids[0]->indexToWorld(openvdb::Vec3d(1, 2, 3)) - there).length(), 1e-5);
    }
  }
  writeVolumeTexture(folder.file("l.nii"), {labels()});
  const auto back =
      openvdb::gridPtrCast<openvdb::Int32Grid>(readVolumeTexture(folder.file("l.nii")).grids[0]);
  const auto accessor = back->getConstAccessor();
  for (auto at = kSmall.begin(); at != kSmall.end(); ++at)
    ASSERT_EQ(accessor.getValue(*at - kSmall.min()), 614454277 + (*at).x());
}

// ITK's axes: x to the left, y to the back; 0 where nothing is active; the grid stays as it was.
TEST(Nifti, DisplacementFieldsAreOfITK) {
  const TemporaryFolder folder;
  const auto field = block<openvdb::Vec3SGrid>(
      "displacement", kSmall,
      [](auto c) { return openvdb::Vec3s(float(c.x()), float(2 * c.y()), float(3 * c.z())); }, 0.5);
  field->tree().setValueOff(kSmall.min());
  const std::string path = folder.file("field.nii.gz");
  writeDisplacementField(path, *field);
  const auto back = openvdb::gridPtrCast<openvdb::Vec3SGrid>(readVolumeTexture(path).grids.front());
  const auto accessor = back->getConstAccessor();
  for (auto at = kSmall.begin(); at != kSmall.end(); ++at) {
    const Coord c = *at;
    const openvdb::Vec3s v = accessor.getValue(c - kSmall.min());
    if (c == kSmall.min())
      ASSERT_EQ(v, openvdb::Vec3s(0));
    else
      ASSERT_EQ(v, openvdb::Vec3s(float(-c.x()), float(-2 * c.y()), float(3 * c.z())));
  }
  EXPECT_EQ(field->getConstAccessor().getValue(kSmall.max()),
            openvdb::Vec3s(float(kSmall.max().x()), float(2 * kSmall.max().y()),
                           float(3 * kSmall.max().z())));
}

TEST(Nifti, DamagedFilesAreRefusedOrRead) {
  const TemporaryFolder folder;
  const MemoryLimit limit(processMemory(std::uint64_t(64) << 20));
  for (const char* name : {"a.nii", "a.nii.gz"}) {
    const std::string good = folder.file(name), bad = folder.file("bad.nii");
    writeVolumeTexture(good, {labels()});
    const std::string bytes = contents(good);
    for (std::size_t size : {std::size_t(0), std::size_t(1), std::size_t(20), std::size_t(100),
                             bytes.size() / 2, bytes.size() - 20}) {
      write(bad, bytes.substr(0, size));
      EXPECT_THROW(readVolumeTexture(bad), Error) << name << " " << size;
    }
    std::mt19937 random(5);
    for (int i = 0; i < 300; ++i) {
      std::string other = bytes;
      for (int k = 0; k < 4; ++k)
        other[random() % std::min<std::size_t>(352, other.size())] = char(random());
      write(bad, other);
      test::refusalOf([&] { readVolumeTexture(bad); });
    }
  }
}

// Counts that the file does not have: refused before memory is taken for them.
TEST(Nifti, CountsBeyondTheFileAreRefused) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.nii");
  writeVolumeTexture(path, {labels()});
  std::string bytes = contents(path);
  for (const int a : {1, 2, 3}) {
    const std::int16_t many = 32000;
    std::memcpy(&bytes[static_cast<std::size_t>(40 + 2 * a)], &many, 2);
    write(path, bytes);
    EXPECT_THROW(readVolumeTexture(path), FileError);
  }
  writeVolumeTexture(path, {labels()});
  test::expectOverLimit(1, [&] { readVolumeTexture(path); });
}

TEST(Nifti, RefusesSettingsOfPicturesAndFormatsThatAreNotRead) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.nii");
  writeVolumeTexture(path, {labels()});
  EXPECT_THROW(readVolumeTexture(path, {.tiles = std::pair{2, 2}}), SettingError);
  EXPECT_THROW(readVolumeTexture(path, {.names = {"a", "b"}}), SettingError);
  const auto grid = readVolumeTexture(path, {.asVoxels = true}).grids[0];
  EXPECT_EQ(grid->indexToWorld(Coord(0)), openvdb::Vec3d(0));
  EXPECT_THROW(readVolumeTexture(folder.file("a.vti")), FileError);
  EXPECT_THROW(writeVolumeTexture(path, {labels(), labels()}), DataError);
}

}  // namespace
}  // namespace innermap
