#include "innermap/levelset/level_set.h"

#include <gtest/gtest.h>
#include <openvdb/tools/Diagnostics.h>

#include "core/expect.h"
#include "core/random.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

using openvdb::FloatGrid;

LevelSetSettings resolution(int n) { return {.resolution = n}; }

// Every active voxel has the solid's own distance, and every inactive one near it the right sign.
void expectRightValues(const FloatGrid& grid, const Solid& solid) {
  const double h = grid.voxelSize()[0];
  EXPECT_EQ(openvdb::tools::checkLevelSet(grid, 8), "");
  std::size_t n = 0;
  const double gap = solid.gap();
  for (auto value = grid.cbeginValueOn(); value; ++value) {
    if (n++ % 7 != 0) continue;
    const openvdb::Vec3d p = grid.indexToWorld(value.getCoord());
    const double d = solid.signedDistance({p[0], p[1], p[2]});
    if (std::abs(d) < 1e-6 * h + 2 * gap) continue;
    ASSERT_NEAR(*value, d, 1e-6 * (std::abs(d) + h));
  }
  EXPECT_GT(n, 1000u);
  const CounterRandom random(3, 3);
  const FloatGrid::ConstAccessor values = grid.getConstAccessor();
  for (int i = 0; i < 3000; ++i) {
    const Vec3 p = solid.box().center() + 0.6 * solid.diagonal() * shapes::randomPoint(random, i);
    const openvdb::Coord c = openvdb::Coord::round(grid.worldToIndex({p.x, p.y, p.z}));
    const openvdb::Vec3d q = grid.indexToWorld(c);
    const double d = solid.signedDistance({q[0], q[1], q[2]});
    if (std::abs(d) < 1e-6 * h + 2 * gap) continue;
    EXPECT_EQ(values.getValue(c) < 0, d < 0);
  }
}

TEST(LevelSet, HoldsExactDistances) {
  for (const Mesh& mesh : {shapes::icosphere(4), shapes::torus(80, 40)}) {
    const Solid solid(mesh);
    const FloatGrid::Ptr grid = makeLevelSet(solid, resolution(60));
    EXPECT_EQ(grid->getName(), "surface");
    EXPECT_EQ(grid->getGridClass(), openvdb::GRID_LEVEL_SET);
    EXPECT_TRUE(grid->hasUniformVoxels());
    EXPECT_NEAR(grid->background(), 3 * grid->voxelSize()[0], 1e-6);
    expectRightValues(*grid, solid);
  }
}

TEST(LevelSet, BandIsAsWideAsAsked) {
  const Solid solid(shapes::icosphere(4));
  for (const double width : {2.0, 6.5}) {
    LevelSetSettings settings = resolution(48);
    settings.halfWidth = width;
    const FloatGrid::Ptr grid = makeLevelSet(solid, settings);
    const double h = grid->voxelSize()[0];
    // The number of voxels in a shell of that width about the unit sphere.
    const double band = width * h;
    const double expected =
        4.0 / 3 * kPi * (std::pow(1 + band, 3) - std::pow(1 - band, 3)) / (h * h * h);
    EXPECT_NEAR(static_cast<double>(grid->activeVoxelCount()), expected, 0.03 * expected);
  }
}

TEST(LevelSetRelease, InteriorVoxelsAreCountedInTheBandAndBelow) {
  for (const double width : {2.0, 20.0}) {  // with and without tiles inside
    LevelSetSettings settings = resolution(48);
    settings.halfWidth = width;
    const FloatGrid::Ptr grid = makeLevelSet(Solid(shapes::icosphere(4)), settings);
    const double cell = std::pow(grid->voxelSize()[0], 3);
    EXPECT_NEAR(static_cast<double>(interiorVoxels(*grid)) * cell, 4.0 / 3 * kPi, 0.03);
  }
}

TEST(LevelSet, FacesBetweenVoxelsDoNotLeak) {
  // All faces lie just between two voxels, or on voxel centres.
  for (const int n : {16, 32, 33, 100}) {
    SCOPED_TRACE(n);
    const Solid solid(shapes::box({0, 0, 0}, {1, 1, 1}));
    const FloatGrid::Ptr grid = makeLevelSet(solid, resolution(n));
    expectRightValues(*grid, solid);
    EXPECT_NEAR(insideVolume(*grid), 1, 0.02);
  }
}

TEST(LevelSet, OverlapsCavitiesAndHoles) {
  const Mesh overlapping =
      shapes::joined(shapes::torus(60, 30), shapes::icosphere(3, 0.5, {1, 0.1, 0.2}));
  const Mesh hollow =
      shapes::joined(shapes::icosphere(4), shapes::flipped(shapes::icosphere(3, 0.5)));
  Mesh open = shapes::icosphere(4);
  open.triangles.resize(open.triangles.size() - 40);
  for (const Mesh& mesh : {overlapping, hollow, open}) {
    SCOPED_TRACE(mesh.name);
    const Solid solid(mesh);
    const FloatGrid::Ptr grid = makeLevelSet(solid, resolution(64));
    expectRightValues(*grid, solid);
    const LevelSetCheck check = checkLevelSet(*grid, solid);
    EXPECT_LT(check.volumeError, 0.01);
    EXPECT_EQ(check.lostSurface, 0);
    EXPECT_TRUE(check.warnings.empty());
  }
}

TEST(LevelSet, ScaleAndPlaceDoNotMatter) {
  const Mesh mesh = shapes::torus(60, 30);
  const Solid solid(mesh);
  const FloatGrid::Ptr grid = makeLevelSet(solid, resolution(40));
  for (const double scale : {1e-3, 1e3}) {
    const Vec3 shift = scale * 1000 * solid.diagonal() * Vec3{0.6, -0.64, 0.48};
    const Solid moved(shapes::transformed(mesh, scale, shift));
    const FloatGrid::Ptr other = makeLevelSet(moved, resolution(40));
    const FloatGrid::ConstAccessor values = other->getConstAccessor();
    for (auto value = grid->cbeginValueOn(); value; ++value)
      ASSERT_NEAR(values.getValue(value.getCoord()) / scale, *value, 1e-6);
  }
}

TEST(LevelSet, OneLatticeForSeveralSolids) {
  LevelSetSettings settings{.voxelSize = 0.1, .origin = Vec3{0.01, -0.02, 5}};
  const auto here = makeLevelSet(Solid(shapes::icosphere(3)), settings),
             there = makeLevelSet(Solid(shapes::icosphere(3, 1, {0.5, 20 * 0.1, -3})), settings);
  EXPECT_EQ(here->transform(), there->transform());
  const openvdb::Vec3d first = here->indexToWorld(openvdb::Vec3d(0));
  EXPECT_NEAR(first.x(), 0.01, 1e-15);
  EXPECT_NEAR(first.z(), 5, 1e-15);
  // The same ball five voxels, twenty and thirty away.
  EXPECT_EQ(here->activeVoxelCount(), there->activeVoxelCount());
  const openvdb::Coord far(5, 20, -30);
  for (auto v = here->cbeginValueOn(); v; ++v)
    ASSERT_NEAR(*v, there->tree().getValue(v.getCoord() + far), 1e-6);
  settings.origin = Vec3{1e9, 0, 0};
  EXPECT_THROW(makeLevelSet(Solid(shapes::icosphere(2)), settings), SettingError);
}

TEST(LevelSet, LatticeOfAnother) {
  const Solid ball(shapes::icosphere(3)), larger(shapes::icosphere(3, 2, {0.3, 7, 0}));
  const auto own = makeLevelSet(ball, resolution(20));
  const LevelSetSettings settings = onLatticeOf(ball, resolution(20));
  EXPECT_EQ(makeLevelSet(ball, settings)->transform(), own->transform());
  EXPECT_EQ(makeLevelSet(larger, settings)->transform(), own->transform());
}

TEST(LevelSet, SettingsOutOfRange) {
  const Solid solid(shapes::icosphere(2));
  EXPECT_THROW(makeLevelSet(solid, {.resolution = 3}), SettingError);
  EXPECT_THROW(makeLevelSet(solid, {.resolution = 4097}), SettingError);
  EXPECT_THROW(makeLevelSet(solid, {.voxelSize = -1}), SettingError);
  EXPECT_THROW(makeLevelSet(solid, {.voxelSize = std::nan("")}), SettingError);
  EXPECT_THROW(makeLevelSet(solid, {.voxelSize = 1e-9}), SettingError);
  EXPECT_THROW(makeLevelSet(solid, {.halfWidth = 1.9}), SettingError);
  EXPECT_THROW(makeLevelSet(solid, {.halfWidth = 101}), SettingError);
  test::expectOverLimit(1000, [&] { makeLevelSet(solid); });
  test::expectCancels([&] { makeLevelSet(solid); });
  EXPECT_EQ(voxelSizeFor(solid, {.voxelSize = 0.5}), 0.5);
}

TEST(LevelSetRelease, MemoryEstimateBoundsTheTree) {
  const Solid solid(shapes::torus(100, 50));
  for (const int n : {96, 192}) {
    for (const double width : {3.0, 8.0}) {
      LevelSetSettings settings = resolution(n);
      settings.halfWidth = width;
      const double need = static_cast<double>(makeLevelSet(solid, settings)->memUsage());
      const double estimate = static_cast<double>(levelSetMemory(solid, settings));
      EXPECT_GT(estimate, need);
      EXPECT_LT(estimate, 2.2 * need + 4e6);
    }
  }
}

// A resolution that nobody gave.
TEST(AutomaticVoxels, AreFineEnoughForThinSolids) {
  const auto voxels = [](const Solid& solid) {
    return solid.box().extent().x / voxelSizeFor(solid, LevelSetSettings());
  };
  const Solid usual(shapes::icosphere(3)), plate(shapes::box({0, 0, 0}, {1, 1, 0.005})),
      needle(shapes::box({0, 0, 0}, {1, 1e-3, 1e-3}));
  EXPECT_NEAR(voxels(usual), kUsualResolution, 1e-6);
  EXPECT_EQ(voxelSizeNote(usual, LevelSetSettings()), "");
  for (const Solid& thin : {plate, needle}) {
    EXPECT_GT(voxels(thin), 200);
    EXPECT_LT(voxels(thin), 4096);
    EXPECT_NE(voxelSizeNote(thin, LevelSetSettings()), "");
    const openvdb::FloatGrid::Ptr grid = makeLevelSet(thin);
    EXPECT_GT(interiorVoxels(*grid), 0U);
    EXPECT_LT(checkLevelSet(*grid, thin).lostSurface, 0.01);
  }
  EXPECT_NEAR(voxelSizeFor(needle, resolution(40)), 1.0 / 40, 1e-9);
}

TEST(AutomaticVoxels, HeedTheMemoryLimit) {
  const Solid plate(shapes::box({0, 0, 0}, {1, 1, 2e-3}));
  const double fine = [&] {
    const MemoryLimit large(1'000'000'000);
    return voxelSizeFor(plate, {});
  }();
  constexpr std::uint64_t kSmall = 200'000'000;
  const MemoryLimit small(kSmall);
  EXPECT_GT(voxelSizeFor(plate, {}), 1.5 * fine);
  EXPECT_LE(levelSetMemory(plate, {}), kSmall);
  const std::string note = voxelSizeNote(plate, {});
  EXPECT_NE(note.find("75"), std::string::npos) << note;
}

TEST(AutomaticVoxels, SayWhatHopelesslyThinSolidsWouldTake) {
  const Solid plate(shapes::box({0, 0, 0}, {1, 1, 1e-4}));
  EXPECT_NEAR(voxelSizeFor(plate, LevelSetSettings()), 1.0 / kUsualResolution, 1e-9);
  const std::string need = "a resolution of 1500";
  const std::string note = voxelSizeNote(plate, LevelSetSettings());
  EXPECT_NE(note.find(need), std::string::npos) << note;
  EXPECT_NE(note.find("4096"), std::string::npos) << note;
  test::expectRefused<DataError>([&] { requireInterior(0, plate, "plate"); }, need);
  EXPECT_NO_THROW(requireInterior(1, plate, "plate"));
}

TEST(LevelSetCheck, ThinSheetsAreSaidToBeLost) {
  // A plate much thinner than the voxels, between two layers of them, beside a box.
  const Solid solid(shapes::joined(shapes::box({0, 0, 0}, {1, 1, 1}),
                                   shapes::box({1.2, 0, 0.501}, {2.2, 1, 0.502})));
  const LevelSetCheck check = checkLevelSet(*makeLevelSet(solid, resolution(22)), solid);
  EXPECT_GT(check.lostSurface, 0.1);
  EXPECT_LT(check.lostSurface, 0.5);
  EXPECT_FALSE(check.warnings.empty());
}

TEST(Attributes, FollowTheClosestPoint) {
  Mesh mesh = shapes::icosphere(4);
  mesh.colours.resize(mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    for (int a = 0; a < 3; ++a)
      mesh.colours[v][a] = static_cast<float>(0.5 + 0.5 * mesh.vertices[v][a]);
  // One texture vertex a corner, as at seams everywhere.
  for (const Triangle& t : mesh.triangles) {
    const int n = static_cast<int>(mesh.uvs.size());
    for (const int v : t) mesh.uvs.push_back({2 * mesh.vertices[v].x, 3 * mesh.vertices[v].z});
    mesh.uvTriangles.push_back({n, n + 1, n + 2});
  }
  // Turned triangles and a hole, which repair turns back and caps.
  for (std::size_t t = 0; t < 100; ++t) {
    std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
    std::swap(mesh.uvTriangles[t][0], mesh.uvTriangles[t][1]);
  }
  mesh.triangles.resize(mesh.triangles.size() - 30);
  mesh.uvTriangles.resize(mesh.triangles.size());
  const Solid solid(mesh);
  ASSERT_GT(solid.repaired().caps, 0);
  const FloatGrid::Ptr levelSet = makeLevelSet(solid, resolution(40));
  const auto grids = makeAttributeGrids(*levelSet, solid, mesh);
  ASSERT_EQ(grids.size(), 2u);
  const auto uv = openvdb::gridPtrCast<openvdb::Vec3SGrid>(grids[0]);
  const auto colour = openvdb::gridPtrCast<openvdb::Vec3SGrid>(grids[1]);
  EXPECT_EQ(uv->getName(), "uv");
  EXPECT_EQ(colour->getName(), "Cd");
  EXPECT_TRUE(uv->tree().hasSameTopology(levelSet->tree()));
  EXPECT_TRUE(colour->tree().hasSameTopology(levelSet->tree()));
  std::size_t onCaps = 0;
  for (auto value = uv->cbeginValueOn(); value; ++value) {
    const openvdb::Vec3d w = uv->indexToWorld(value.getCoord());
    const Solid::Closest c = solid.closest({w[0], w[1], w[2]}, 100);
    const int t = solid.address(c.onSurface).triangle;
    if (solid.repaired().parent[t] < 0) {
      ++onCaps;  // the value comes from the rim
      EXPECT_GT(norm(Vec3{(*value)[0] / 2.0, 0, (*value)[1] / 3.0}), 0.01);
      continue;
    }
    ASSERT_NEAR((*value)[0], 2 * c.position.x, 1e-5);
    ASSERT_NEAR((*value)[1], 3 * c.position.z, 1e-5);
    const openvdb::Vec3f rgb = colour->tree().getValue(value.getCoord());
    for (int a = 0; a < 3; ++a) ASSERT_NEAR(rgb[a], 0.5 + 0.5 * c.position[a], 1e-5);
  }
  EXPECT_GT(onCaps, 0u);
  Mesh other = shapes::icosphere(1);
  EXPECT_THROW(makeAttributeGrids(*levelSet, solid, other), DataError);
}

TEST(LevelSet, TinySolidsGetTheSmallestVoxelsThatOpenVdbHolds) {
  const Solid tiny(shapes::icosphere(2, 5e-4));
  EXPECT_DOUBLE_EQ(makeLevelSet(tiny, {.resolution = 128})->voxelSize()[0], kSmallestVoxel);
  EXPECT_THROW(makeLevelSet(Solid(shapes::icosphere(2, 1e-5)), {.resolution = 128}), DataError);
  EXPECT_THROW(makeLevelSet(tiny, {.voxelSize = 1e-5, .resolution = 128}), SettingError);
}

}  // namespace
}  // namespace innermap
