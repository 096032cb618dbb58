#include "innermap/io/vdb_file.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <regex>

#include "core/expect.h"
#include "core/random.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "io/test_files.h"

namespace innermap {
namespace {

using namespace test;

openvdb::GridPtrVec everyType() {
  const auto sum = [](const openvdb::Coord& c) { return c.x() + 100 * c.y() - 7 * c.z(); };
  openvdb::GridPtrVec grids;
  grids.push_back(ball(9.5, openvdb::Vec3d(3, 4, 5), 0.25));
  grids.push_back(block<openvdb::FloatGrid>("float", kBox, [&](auto c) { return sum(c) * 0.5f; }));
  grids.push_back(block<openvdb::DoubleGrid>("double", kBox, [&](auto c) { return sum(c) / 3.0; }));
  grids.push_back(block<openvdb::Int32Grid>("int32", kBox, sum));
  grids.push_back(block<openvdb::Int64Grid>("int64", kBox, sum));
  grids.push_back(
      block<openvdb::BoolGrid>("bool", kBox, [&](auto c) { return (sum(c) & 1) != 0; }));
  grids.push_back(block<openvdb::MaskGrid>("mask", kBox, [](auto) { return true; }));
  grids.push_back(block<openvdb::Vec3SGrid>(
      "map", kBox, [](auto c) { return openvdb::Vec3f(c.x(), 0.1f * c.y(), -c.z()); }));
  grids.push_back(block<openvdb::Vec3DGrid>("vec3d", kBox, [](auto c) { return c.asVec3d() / 7; }));
  grids.push_back(block<openvdb::Vec3IGrid>("vec3i", kBox, [](auto c) { return c.asVec3i(); }));
  auto half = block<openvdb::FloatGrid>("half", kBox, [](auto c) { return float(c.x()); });
  half->setSaveFloatAsHalf(true);
  grids.push_back(half);
  auto halfVector = block<openvdb::Vec3SGrid>("half_vector", kBox,
                                              [](auto c) { return openvdb::Vec3f(c.y(), 2, 3); });
  halfVector->setSaveFloatAsHalf(true);
  grids.push_back(halfVector);
  auto fog = block<openvdb::FloatGrid>("density", kBox, [](auto) { return 1.0f; });
  fog->setGridClass(openvdb::GRID_FOG_VOLUME);
  fog->fill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(200)), 1.0f);
  grids.push_back(fog);
  grids.push_back(openvdb::FloatGrid::create(2.5f));  // no voxel at all
  grids.back()->setName("empty");
  return grids;
}

template <class Grid>
void expectSame(const openvdb::GridBase& a, const openvdb::GridBase& b) {
  const auto& x = static_cast<const Grid&>(a);
  const auto& y = static_cast<const Grid&>(b);
  EXPECT_EQ(x.activeVoxelCount(), y.activeVoxelCount()) << a.getName();
  EXPECT_TRUE(x.tree().hasSameTopology(y.tree())) << a.getName();
  const auto accessor = y.getConstAccessor();
  for (auto it = x.cbeginValueOn(); it; ++it)
    ASSERT_EQ(*it, accessor.getValue(it.getCoord())) << a.getName() << it.getCoord();
  EXPECT_EQ(x.background(), y.background());
}

void expectSame(const openvdb::GridBase& a, const openvdb::GridBase& b) {
  ASSERT_EQ(a.type(), b.type());
  EXPECT_EQ(a.getName(), b.getName());
  EXPECT_EQ(a.getGridClass(), b.getGridClass());
  EXPECT_EQ(a.constTransform(), b.constTransform());
  if (a.isType<openvdb::FloatGrid>()) expectSame<openvdb::FloatGrid>(a, b);
  if (a.isType<openvdb::DoubleGrid>()) expectSame<openvdb::DoubleGrid>(a, b);
  if (a.isType<openvdb::Int32Grid>()) expectSame<openvdb::Int32Grid>(a, b);
  if (a.isType<openvdb::Int64Grid>()) expectSame<openvdb::Int64Grid>(a, b);
  if (a.isType<openvdb::BoolGrid>()) expectSame<openvdb::BoolGrid>(a, b);
  if (a.isType<openvdb::MaskGrid>()) expectSame<openvdb::MaskGrid>(a, b);
  if (a.isType<openvdb::Vec3SGrid>()) expectSame<openvdb::Vec3SGrid>(a, b);
  if (a.isType<openvdb::Vec3DGrid>()) expectSame<openvdb::Vec3DGrid>(a, b);
  if (a.isType<openvdb::Vec3IGrid>()) expectSame<openvdb::Vec3IGrid>(a, b);
}

class VdbFile : public ::testing::TestWithParam<VdbCompression> {};

TEST_P(VdbFile, ReadsBackEveryTypeItWrites) {
  const TemporaryFolder folder;
  const openvdb::GridPtrVec grids = everyType();
  openvdb::MetaMap metadata;
  metadata.insertMeta("innermap_note", openvdb::StringMetadata("hello"));
  writeVdb(folder.file("a.vdb"), grids, metadata, {.compression = GetParam()});
  EXPECT_EQ(folder.count(), 1u);
  const VdbContents back = readVdb(folder.file("a.vdb"));
  ASSERT_EQ(back.grids.size(), grids.size());
  for (std::size_t i = 0; i < grids.size(); ++i) expectSame(*grids[i], *back.grids[i]);
  EXPECT_EQ(back.metadata.metaValue<std::string>("innermap_note"), "hello");
  EXPECT_EQ(back.metadata.metaValue<std::string>("creator").rfind("innermap ", 0), 0u);
}

// OpenVDB's own reader must see what ours sees, one grid at a time by its offsets.
TEST_P(VdbFile, IsReadByOpenVdb) {
  const TemporaryFolder folder;
  const openvdb::GridPtrVec grids = everyType();
  writeVdb(folder.file("a.vdb"), grids, {}, {.compression = GetParam()});
  openvdb::io::File file(folder.file("a.vdb"));
  file.open(false);
  for (const auto& grid : grids) {
    const auto back = file.readGrid(grid->getName());
    expectSame(*grid, *back);
    EXPECT_EQ(back->metaValue<openvdb::Int64>("file_voxel_count"),
              static_cast<openvdb::Int64>(grid->activeVoxelCount()));
  }
}

// And ours must read what openvdb::io::File writes, lazy loading's tables included.
TEST_P(VdbFile, ReadsWhatOpenVdbWrites) {
  const TemporaryFolder folder;
  const openvdb::GridPtrVec grids = everyType();
  openvdb::io::File file(folder.file("a.vdb"));
  file.setCompression(openvdb::io::COMPRESS_ACTIVE_MASK |
                      (GetParam() == VdbCompression::zip     ? openvdb::io::COMPRESS_ZIP
                       : GetParam() == VdbCompression::blosc ? openvdb::io::COMPRESS_BLOSC
                                                             : openvdb::io::COMPRESS_NONE));
  openvdb::GridPtrVec written = grids;
  written.push_back(grids[1]->copyGrid());  // shares its tree: an instance
  written.back()->setName("twin");
  written.back()->transform().preScale(2.0);
  file.write(written);
  file.close();
  const VdbContents back = readVdb(folder.file("a.vdb"));
  ASSERT_EQ(back.grids.size(), written.size());
  for (std::size_t i = 0; i < written.size(); ++i) expectSame(*written[i], *back.grids[i]);
}

INSTANTIATE_TEST_SUITE_P(Compressions, VdbFile,
                         ::testing::Values(VdbCompression::none, VdbCompression::zip,
                                           VdbCompression::blosc));

TEST(VdbFileBytes, AreThoseOfTheGrids) {
  const TemporaryFolder folder;
  writeVdb(folder.file("a.vdb"), everyType());
  writeVdb(folder.file("b.vdb"), everyType());
  const std::string first = contents(folder.file("a.vdb"));
  EXPECT_EQ(first, contents(folder.file("b.vdb")));
  openvdb::GridPtrVec changed = everyType();
  auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(changed.front());
  ASSERT_TRUE(grid);
  grid->tree().setValue({1, 2, 3}, 4.5f);
  writeVdb(folder.file("c.vdb"), changed);
  const auto uuid = [](const std::string& bytes) { return bytes.substr(21, 36); };
  const std::string other = uuid(contents(folder.file("c.vdb")));
  EXPECT_NE(uuid(first), other);
  EXPECT_TRUE(std::regex_match(
      other, std::regex("[0-9a-f]{8}-[0-9a-f]{4}-8[0-9a-f]{3}-a[0-9a-f]{3}-[0-9a-f]{12}")))
      << other;
}

TEST(VdbFileNames, ReadsOnlyWhatIsAskedFor) {
  const TemporaryFolder folder;
  writeVdb(folder.file("a.vdb"), everyType());
  const VdbContents back = readVdb(folder.file("a.vdb"), {.names = {"map", "surface"}});
  ASSERT_EQ(back.grids.size(), 2u);
  EXPECT_EQ(back.grids[0]->getName(), "surface");
  EXPECT_EQ(back.grids[1]->getName(), "map");
  const std::string text =
      test::refusalOf<FileError>([&] { readVdb(folder.file("a.vdb"), {.names = {"jacobi"}}); });
  EXPECT_NE(text.find("jacobi"), std::string::npos) << text;
  EXPECT_NE(text.find("surface, float, double"), std::string::npos) << text;
}

TEST(VdbFileNames, RenamesForBlenderAndLeavesTheGridsAlone) {
  const TemporaryFolder folder;
  const auto colour =
      block<openvdb::Vec3SGrid>("Cd", kBox, [](auto) { return openvdb::Vec3f(1, 0, 0); });
  writeVdb(folder.file("a.vdb"), {colour}, {}, {.names = NamingScheme::blender});
  EXPECT_EQ(colour->getName(), "Cd");
  EXPECT_EQ(readVdb(folder.file("a.vdb")).grids[0]->getName(), "color");
  EXPECT_EQ(gridName("map", NamingScheme::blender), "map");
  EXPECT_EQ(gridName("Cd", NamingScheme::houdini), "Cd");
  EXPECT_EQ(gridName("velocity", NamingScheme::houdini), "v");
  EXPECT_EQ(gridName("velocity", NamingScheme::blender), "velocity");
}

TEST(VdbFileNames, RefusesNamesThatProgramsConfuse) {
  const TemporaryFolder folder;
  const auto make = [](const std::string& name) {
    return block<openvdb::FloatGrid>(name, kBox, [](auto) { return 1.0f; });
  };
  EXPECT_THROW(writeVdb(folder.file("a.vdb"), {make("a"), make("a")}), DataError);
  EXPECT_THROW(writeVdb(folder.file("a.vdb"), {make("")}), DataError);
  EXPECT_THROW(writeVdb(folder.file("a.vdb"), {make(std::string(64, 'x'))}), DataError);
  EXPECT_EQ(folder.count(), 0u);
}

TEST(VdbFileInfo, TellsWithoutReading) {
  const TemporaryFolder folder;
  const openvdb::GridPtrVec grids = everyType();
  writeVdb(folder.file("a.vdb"), grids);
  const VdbInfo info = readVdbInfo(folder.file("a.vdb"));
  EXPECT_EQ(readMemory(info, {info.grids[0].name}), info.grids[0].memory);
  EXPECT_GT(readMemory(info), info.grids[0].memory);
  EXPECT_EQ(describe(info, "a.vdb").substr(0, 14), "a.vdb: OpenVDB");
  EXPECT_GT(describe(info, "a.vdb", true).size(), describe(info, "a.vdb").size());
  ASSERT_EQ(info.grids.size(), grids.size());
  EXPECT_EQ(info.grids[0].name, "surface");
  EXPECT_EQ(info.grids[0].type, "float");
  EXPECT_EQ(info.grids[0].gridClass, "level set");
  EXPECT_EQ(info.grids[7].type, "vec3s");
  EXPECT_EQ(info.grids[10].type, "float (half)");
  for (std::size_t i = 0; i < grids.size(); ++i) {
    EXPECT_EQ(info.grids[i].grid->activeVoxelCount(), 0u);
    EXPECT_EQ(info.grids[i].grid->metaValue<openvdb::Int64>("file_voxel_count"),
              static_cast<openvdb::Int64>(grids[i]->activeVoxelCount()));
    // The prediction covers OpenVDB's own count, and is of its order.
    EXPECT_GE(info.grids[i].memory + 1000, 0.9 * grids[i]->memUsage()) << info.grids[i].name;
    EXPECT_LE(info.grids[i].memory, 4.0 * grids[i]->memUsage() + 1000) << info.grids[i].name;
  }
}

TEST(VdbFileLimits, RefusesWhatDoesNotFit) {
  const TemporaryFolder folder;
  writeVdb(folder.file("a.vdb"), everyType());
  test::expectOverLimit(100000, [&] { readVdb(folder.file("a.vdb"), {}); });
}

TEST(VdbFileLimits, Cancels) {
  const TemporaryFolder folder;
  const openvdb::GridPtrVec grids = everyType();
  writeVdb(folder.file("a.vdb"), grids);
  RunContext run;
  run.cancel();
  const RunScope scope(run);
  EXPECT_THROW(readVdb(folder.file("a.vdb")), Cancelled);
  EXPECT_THROW(writeVdb(folder.file("b.vdb"), grids), Cancelled);
  EXPECT_EQ(folder.count(), 1u);
}

TEST(VdbFileLimits, NoticesAFullDisk) {
  const TemporaryFolder folder;
  const openvdb::GridPtrVec grids = everyType();
  writeVdb(folder.file("a.vdb"), grids);
  const auto size = static_cast<rlim_t>(std::filesystem::file_size(folder.file("a.vdb")));
  for (const rlim_t limit : {rlim_t(0), rlim_t(100), size / 2, size - 1}) {
    SCOPED_TRACE(limit);
    {
      const FullDisk disk(limit);
      EXPECT_THROW(writeVdb(folder.file("b.vdb"), grids), FileError);
    }
    EXPECT_EQ(folder.count(), 1u);
  }
}

TEST(VdbFileDamage, NamesTheFileAndWhatItIs) {
  const TemporaryFolder folder;
  write(folder.file("text.vdb"),
        "this is not a grid, but it is long enough to hold a header, sure");
  write(folder.file("empty.vdb"), "");
  for (const char* name : {"text.vdb", "empty.vdb", "missing.vdb", "."}) {
    const std::string said = test::refusalOf<FileError>([&] { readVdb(folder.file(name)); });
    EXPECT_NE(said.find(name), std::string::npos) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  }
}

TEST(VdbFileDamage, EveryTruncationIsAFileError) {
  const TemporaryFolder folder;
  writeVdb(folder.file("a.vdb"), everyType());
  const std::string whole = contents(folder.file("a.vdb"));
  const CounterRandom random(7, 0);
  const std::uint64_t before = peakMemory();
  for (int i = 0; i < 150; ++i) {
    const std::size_t length =
        i < 60 ? static_cast<std::size_t>(i) * 3
               : static_cast<std::size_t>(random.uniform(i) * static_cast<double>(whole.size()));
    SCOPED_TRACE(length);
    write(folder.file("b.vdb"), whole.substr(0, length));
    EXPECT_THROW(readVdb(folder.file("b.vdb")), FileError);
  }
  EXPECT_LT(peakMemory() - before, 300u << 20);
}

// Flipped bytes either go unnoticed (voxel values have no checksum) or are an Error; never a crash
// or gigabytes of memory.
TEST(VdbFileDamage, FlippedBytesNeverCrash) {
  const TemporaryFolder folder;
  openvdb::GridPtrVec grids = everyType();
  for (const VdbCompression compression :
       {VdbCompression::none, VdbCompression::zip, VdbCompression::blosc}) {
    writeVdb(folder.file("a.vdb"), grids, {}, {.compression = compression});
    const std::string whole = contents(folder.file("a.vdb"));
    const CounterRandom random(11, static_cast<std::uint64_t>(compression));
    for (std::uint64_t i = 0; i < 60; ++i) {
      SCOPED_TRACE(i);
      std::string bytes = whole;
      // The front is all structure; a later byte is mostly voxels.
      const double reach = i % 2 ? 3000.0 : static_cast<double>(whole.size());
      for (std::uint64_t k = 0; k < 1 + i % 3; ++k) {
        const auto at = static_cast<std::size_t>(random.uniform(10 * i + k) * reach);
        bytes[at] = static_cast<char>(random.bits(10 * i + k + 5));
      }
      write(folder.file("b.vdb"), bytes);
      test::refusalOf([&] { readVdb(folder.file("b.vdb")); });
    }
  }
  EXPECT_LT(peakMemory(), std::uint64_t(2) << 30);
}

void replaceAll(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

// A grid says twice whether its voxels are half floats, in its descriptor and in its metadata.
// Where they differ OpenVDB believes the metadata and loses its way; so must the check before.
TEST(VdbFileDamage, HalfFloatsInOnePlaceOnlyAreFoundBeforeReading) {
  const TemporaryFolder folder;
  const std::string key = openvdb::GridBase::META_SAVE_HALF_FLOAT;
  const std::string other(key.size(), 'x');
  for (const VdbCompression compression :
       {VdbCompression::none, VdbCompression::zip, VdbCompression::blosc}) {
    for (const bool described : {true, false}) {
      auto grid = block<openvdb::FloatGrid>("a", kBox, [](auto c) { return float(c.x()); });
      if (described)
        grid->setSaveFloatAsHalf(true);
      else
        grid->insertMeta(other, openvdb::BoolMetadata(true));
      writeVdb(folder.file("a.vdb"), {grid}, {}, {.compression = compression});
      std::string bytes = contents(folder.file("a.vdb"));
      replaceAll(bytes, described ? key : other, described ? other : key);
      write(folder.file("b.vdb"), bytes);
      EXPECT_THROW(readVdb(folder.file("b.vdb")), FileError);
    }
  }
}

TEST(VdbFileDamage, TruthIsZeroOrOne) {
  const TemporaryFolder folder;
  auto grid = block<openvdb::FloatGrid>("a", kBox, [](auto c) { return float(c.x()); });
  grid->setSaveFloatAsHalf(true);
  writeVdb(folder.file("a.vdb"), {grid});
  std::string bytes = contents(folder.file("a.vdb"));
  const std::string before = std::string(openvdb::GridBase::META_SAVE_HALF_FLOAT) +
                             std::string("\4\0\0\0bool\1\0\0\0", 12);
  const std::size_t at = bytes.find(before);
  ASSERT_NE(at, std::string::npos);
  bytes[at + before.size()] = 2;
  write(folder.file("b.vdb"), bytes);
  EXPECT_THROW(readVdb(folder.file("b.vdb")), FileError);
}

// The table for reading leaves later is kept compressed: sixteen bytes may claim two gigabytes.
TEST(VdbFileDamage, TableOfMoreLeavesThanTheFileCanHold) {
  const TemporaryFolder folder;
  auto grid = block<openvdb::FloatGrid>("a", kBox, [](auto c) { return float(c.x()); });
  const std::string type = "__delayedload";
  grid->insertMeta("later", openvdb::StringMetadata(std::string(40, 'x')));
  writeVdb(folder.file("a.vdb"), {grid});
  std::string bytes = contents(folder.file("a.vdb"));
  const std::uint32_t count = 2000000000, stored = 32;
  const std::array<std::uint32_t, 6> table = {count, stored, 0x02010102, count, count, stored};
  const std::size_t at = bytes.find(std::string(40, 'x'));
  ASSERT_NE(at, std::string::npos);
  std::memcpy(bytes.data() + at, table.data(), sizeof(table));
  // The type's name is longer than "string" was, so the offsets that follow are wrong as well; the
  // table comes first.
  const std::size_t name = bytes.rfind("string", at);
  const auto length = static_cast<char>(type.size());
  bytes.replace(name, 6, type);
  bytes[name - 4] = length;
  write(folder.file("b.vdb"), bytes);
  const std::uint64_t before = peakMemory();
  EXPECT_THROW(readVdb(folder.file("b.vdb")), FileError);
  EXPECT_LT(peakMemory() - before, 300u << 20);
}

}  // namespace
}  // namespace innermap
