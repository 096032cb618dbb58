#include "innermap/levelset/isosurface.h"

#include <gtest/gtest.h>

#include <map>

#include "innermap/core/error.h"
#include "innermap/core/parallel.h"
#include "innermap/mesh/check.h"
#include "innermap/mesh/read.h"
#include "mesh/test_meshes.h"

namespace innermap {
namespace {

// Closed, manifold, oriented: each side of a triangle once, and once the other way.
void expectClosed(const Mesh& mesh) {
  validate(mesh);
  std::map<std::array<int, 2>, int> sides;
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) ++sides[{t[k], t[(k + 1) % 3]}];
  for (const auto& [side, count] : sides) {
    ASSERT_EQ(count, 1);
    ASSERT_EQ(sides.count({side[1], side[0]}), 1u);
  }
  EXPECT_GT(signedVolume(mesh), 0);
}

Isosurface isosurface(const Mesh& mesh, int resolution, double least = 1e-3) {
  IsosurfaceSettings settings;
  settings.resolution = resolution;
  settings.leastShell = least;
  return isosurfaceOf(Solid(mesh), settings);
}

TEST(Isosurface, IsCloseToTheSolid) {
  for (const Mesh& mesh :
       {shapes::icosphere(4, 2, {5, 6, 7}), shapes::torus(60, 30), testing::cube()}) {
    const Isosurface iso = isosurface(mesh, 40);
    expectClosed(iso.mesh);
    EXPECT_EQ(iso.shells, 1u);
    EXPECT_EQ(iso.leftOut, 0u);
    EXPECT_NEAR(signedVolume(iso.mesh), signedVolume(mesh), 0.01 * signedVolume(mesh));
    const Solid solid(mesh);
    for (const Vec3& p : iso.mesh.vertices) EXPECT_LT(solid.distance(p), 0.5 * iso.voxelSize);
  }
  EXPECT_EQ(checkMesh(isosurface(shapes::torus(60, 30), 40).mesh).genus, 1);
}

TEST(Isosurface, TrianglesAreWellShaped) {
  const Isosurface iso = isosurface(shapes::icosphere(4), 32);
  std::size_t thin = 0;
  for (int t = 0; t < static_cast<int>(iso.mesh.triangles.size()); ++t) {
    double longest = 0;
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, norm(iso.mesh.vertices[iso.mesh.triangles[t][k]] -
                                       iso.mesh.vertices[iso.mesh.triangles[t][(k + 1) % 3]]));
    if (2 * norm(areaVector(iso.mesh, t)) < 0.1 * longest * longest) ++thin;
  }
  EXPECT_LT(thin, iso.mesh.triangles.size() / 100);
}

TEST(Isosurface, OverlappingPartsAndHolesMakeOneSurface) {
  Mesh mesh = shapes::joined(shapes::icosphere(3), shapes::icosphere(3, 0.8, {1, 0.1, 0.2}));
  mesh.triangles.erase(mesh.triangles.begin() + 5);
  const Isosurface iso = isosurface(mesh, 48);
  expectClosed(iso.mesh);
  EXPECT_EQ(iso.shells, 1u);
  EXPECT_EQ(checkMesh(iso.mesh).genus, 0);
}

TEST(Isosurface, AmbiguousCellsStayManifold) {
  // Many small parts at all distances and angles: every case of the table, close sheets.
  const CounterRandom random(3, 1);
  Mesh mesh = testing::cube(0.2);
  for (int i = 0; i < 60; ++i) {
    const Vec3 p = shapes::randomPoint(random, static_cast<std::uint64_t>(i));
    mesh = shapes::joined(mesh, shapes::transformed(testing::cube(), 0.1 + 0.1 * (i % 3), p));
  }
  SolidSettings coarse;
  coarse.pieceSize = 1.0 / 64;
  const Solid solid(mesh, coarse);
  IsosurfaceSettings settings;
  settings.leastShell = 0;
  for (const int resolution : {8, 17, 40}) {
    settings.resolution = resolution;
    expectClosed(isosurfaceOf(solid, settings).mesh);
  }
}

TEST(Isosurface, SmallShellsAreLeftOutAndCavitiesAreKept) {
  Mesh mesh = shapes::joined(shapes::icosphere(3), shapes::flipped(shapes::icosphere(3, 0.5)));
  mesh = shapes::joined(mesh, shapes::icosphere(2, 0.05, {1.3, 0, 0}));
  const Isosurface iso = isosurface(mesh, 64);
  expectClosed(iso.mesh);
  EXPECT_EQ(iso.shells, 2u);
  EXPECT_EQ(iso.leftOut, 1u);
  EXPECT_EQ(isosurface(mesh, 64, 0).shells, 3u);
}

TEST(Isosurface, RealModelsThatAreOpenAndDirty) {
  const std::string models = INNERMAP_MODELS;
  for (const std::string name : {"suzanne", "teapot"}) {
    Mesh mesh;
    try {
      mesh = readMesh(models + "/" + name + ".obj");
    } catch (const FileError&) {
      GTEST_SKIP() << "no models at " << models;
    }
    expectClosed(isosurface(mesh, 64).mesh);
  }
}

TEST(Isosurface, IsTheSameForAnyNumberOfThreads) {
  const Mesh mesh = shapes::torus(30, 20);
  const Isosurface many = isosurface(mesh, 40);
  const ThreadLimit limit(1);
  const Isosurface one = isosurface(mesh, 40);
  ASSERT_EQ(many.mesh.triangles, one.mesh.triangles);
  for (std::size_t v = 0; v < one.mesh.vertices.size(); ++v)
    EXPECT_EQ(norm(one.mesh.vertices[v] - many.mesh.vertices[v]), 0);
}

TEST(Isosurface, RefusesSettingsAndCanBeCancelled) {
  const Solid solid(testing::cube());
  IsosurfaceSettings settings;
  settings.resolution = 4;
  EXPECT_THROW(isosurfaceOf(solid, settings), SettingError);
  settings = {};
  settings.leastShell = 1;
  EXPECT_THROW(isosurfaceOf(solid, settings), SettingError);
  settings = {};
  Progress progress;
  progress.cancel();
  settings.progress = &progress;
  EXPECT_THROW(isosurfaceOf(solid, settings), Cancelled);
}

}  // namespace
}  // namespace innermap
