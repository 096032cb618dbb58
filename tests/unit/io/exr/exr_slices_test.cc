#include "innermap/io/exr_slices.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <gtest/gtest.h>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/io/pictures.h"
#include "io/test_files.h"

namespace innermap {
namespace {

using namespace test;

openvdb::GridPtrVec twoGrids() { return {scalar(), vectors("map")}; }

std::vector<float> channel(Imf::MultiPartInputFile& file, int part, const std::string& name,
                           std::size_t columns, std::size_t rows) {
  std::vector<float> values(columns * rows, -1);
  Imf::FrameBuffer buffer;
  buffer.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float),
                                 sizeof(float) * columns));
  Imf::InputPart input(file, part);
  input.setFrameBuffer(buffer);
  input.readPixels(0, static_cast<int>(rows) - 1);
  return values;
}

TEST(ExrSlices, HoldsTheVoxelsWithTheirPlaces) {
  const TemporaryFolder folder;
  const auto grids = twoGrids();
  const ExrSliceResult result =
      writeExrSlices(folder.file("s.exr"), grids, {.axis = 1, .count = 3});
  EXPECT_EQ(result.slices, 3);
  EXPECT_EQ(folder.count(), 1u);
  const SliceFrame frame = sliceFrame(grids, 1);
  const std::vector<int> layers = sliceLayers(frame, 3);
  Imf::MultiPartInputFile file(folder.file("s.exr").c_str());
  ASSERT_EQ(file.parts(), 3);
  for (int part = 0; part < 3; ++part) {
    const Imf::Header& h = file.header(part);
    EXPECT_EQ(h.name(), "y_000" + std::to_string(part));
    EXPECT_EQ(h.findTypedAttribute<Imf::StringAttribute>("sliceAxis")->value(), "y");
    EXPECT_EQ(h.findTypedAttribute<Imf::IntAttribute>("sliceIndex")->value(), layers[part]);
    EXPECT_EQ(h.findTypedAttribute<Imf::DoubleAttribute>("slicePosition")->value(),
              0.5 * layers[part]);
    EXPECT_EQ(h.findTypedAttribute<Imf::DoubleAttribute>("voxelSize")->value(), 0.5);
    const Imath::M44d m = h.findTypedAttribute<Imf::M44dAttribute>("imageToWorld")->value();
    const Imath::V3d w = Imath::V3d(7, 4, 0) * m;
    const Vec3 expected = frame.world(7, 4, layers[part]);
    EXPECT_NEAR(w.x, expected.x, 1e-12);
    EXPECT_NEAR(w.y, expected.y, 1e-12);
    EXPECT_NEAR(w.z, expected.z, 1e-12);
    for (const auto& grid : grids)
      for (const SliceChannel& c : sliceGrid(*grid, frame, layers[part]))
        EXPECT_EQ(channel(file, part, c.name, frame.columns(), frame.rows()), c.values) << c.name;
    // Nothing else tells where the solid is.
    EXPECT_EQ(channel(file, part, "mask.V", frame.columns(), frame.rows()),
              sliceMask(grids, frame, layers[part]));
  }
}

TEST(ExrSlices, NeedsNoMaskBesideADensity) {
  const TemporaryFolder folder;
  auto grids = twoGrids();
  grids.push_back(block<openvdb::FloatGrid>(
      "density", kBox, [](auto) { return 1.0f; }, 0.5));
  writeExrSlices(folder.file("s.exr"), grids, {});
  const auto parts = readExrInfo(folder.file("s.exr"));
  ASSERT_EQ(parts.size(), 12u);  // the box has no more layers
  EXPECT_EQ(parts[0].channels,
            (std::vector<std::string>{"density.V", "jacobian.V", "map.X", "map.Y", "map.Z"}));
  EXPECT_EQ(parts[11].name, "z_0011");
  EXPECT_EQ(parts[0].width, 18);
  EXPECT_EQ(parts[0].height, 8);
}

TEST(ExrSlices, HalfFloatsAreClampedAndCounted) {
  const TemporaryFolder folder;
  auto grid = block<openvdb::FloatGrid>("v", kBox, [](auto) { return 1.5f; });
  grid->tree().setValue(openvdb::Coord(0, 4, 35), 1e6f);
  grid->tree().setValue(openvdb::Coord(1, 4, 35), -1e6f);
  const ExrSliceResult result = writeExrSlices(folder.file("s.exr"), {grid}, {.half = true});
  EXPECT_EQ(result.clamped, 2u);
  Imf::MultiPartInputFile file(folder.file("s.exr").c_str());
  EXPECT_EQ(file.header(0).channels().findChannel("v.V")->type, Imf::HALF);
}

TEST(ExrSlices, RefusesBeforeItWrites) {
  const TemporaryFolder folder;
  test::expectOverLimit(100, [&] { writeExrSlices(folder.file("s.exr"), twoGrids(), {}); });
  EXPECT_GT(exrSliceMemory(twoGrids(), {}), 18u * 8 * 5 * 4);
  EXPECT_THROW(writeExrSlices(folder.file("s.exr"), twoGrids(), {.count = 0}), SettingError);
  RunContext run;
  run.cancel();
  const RunScope scope(run);
  EXPECT_THROW(writeExrSlices(folder.file("s.exr"), twoGrids(), {}), Cancelled);
  EXPECT_EQ(folder.count(), 0u);
}

TEST(ExrSlices, NoticesAFullDisk) {
  const TemporaryFolder folder;
  const auto grids = twoGrids();
  writeExrSlices(folder.file("s.exr"), grids, {});
  const auto size = static_cast<rlim_t>(std::filesystem::file_size(folder.file("s.exr")));
  for (const rlim_t limit : {rlim_t(0), size / 2, size - 1}) {
    SCOPED_TRACE(limit);
    {
      const FullDisk disk(limit);
      EXPECT_THROW(writeExrSlices(folder.file("t.exr"), grids, {}), FileError);
    }
    EXPECT_EQ(folder.count(), 1u);
  }
}

}  // namespace
}  // namespace innermap
