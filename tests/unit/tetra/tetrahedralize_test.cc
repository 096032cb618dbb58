#include "innermap/tetra/tetrahedralize.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "innermap/core/detail/pi.h"
#include "innermap/core/error.h"
#include "innermap/core/parallel.h"
#include "innermap/tetra/cell_quality.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

TetrahedralizeSettings across(int resolution) {
  TetrahedralizeSettings settings;
  settings.resolution = resolution;
  return settings;
}

double volumeOf(const CellMesh& mesh) {
  double sum = 0;
  for (const Tetrahedron& t : mesh.tetrahedra) sum += signedVolume(mesh.vertices, t);
  return sum;
}

struct Shell {
  long euler = 0;
  long unpaired = 0;  // edges that do not have two triangles
};

Shell shellOf(const CellMesh& mesh) {
  std::map<std::pair<int, int>, int> edges;
  std::map<int, int> vertices;
  const std::vector<Triangle> boundary = boundaryTriangles(mesh);
  for (const Triangle& t : boundary)
    for (int k = 0; k < 3; ++k) {
      ++vertices[t[k]];
      ++edges[std::minmax(t[k], t[(k + 1) % 3])];
    }
  Shell shell;
  shell.euler = static_cast<long>(vertices.size()) - static_cast<long>(edges.size()) +
                static_cast<long>(boundary.size());
  for (const auto& edge : edges) shell.unpaired += edge.second != 2;
  return shell;
}

void expectWellShaped(const CellMesh& mesh) {
  validate(mesh);
  const CellQuality quality = cellQuality(mesh);
  EXPECT_EQ(quality.invertedTetrahedra, 0u);
  EXPECT_GE(quality.dihedral.least, 10 - 1e-4);
  EXPECT_LE(quality.greatestAngle, 165 + 1e-4);
}

TEST(Tetrahedralize, FillsASphere) {
  const Mesh sphere = shapes::icosphere(4);
  const Solid solid(sphere);
  const CellMesh mesh = tetrahedralize(solid, across(24));
  expectWellShaped(mesh);
  EXPECT_NEAR(volumeOf(mesh), solid.volume(), 0.01 * solid.volume());
  EXPECT_EQ(shellOf(mesh).euler, 2);
  EXPECT_EQ(shellOf(mesh).unpaired, 0);
  for (const Triangle& t : boundaryTriangles(mesh))
    for (const int v : t) EXPECT_LT(solid.distance(mesh.vertices[v]), 1e-12);
}

TEST(Tetrahedralize, KeepsHandlesAndCavities) {
  const CellMesh torus = tetrahedralize(Solid(shapes::torus(64, 32)), across(32));
  expectWellShaped(torus);
  EXPECT_EQ(shellOf(torus).euler, 0);
  EXPECT_EQ(shellOf(torus).unpaired, 0);
  Mesh hollow = shapes::icosphere(4, 0.5);
  for (Triangle& t : hollow.triangles) std::swap(t[0], t[1]);
  const CellMesh shell =
      tetrahedralize(Solid(shapes::joined(shapes::icosphere(4), hollow)), across(32));
  expectWellShaped(shell);
  EXPECT_EQ(shellOf(shell).euler, 4);
}

TEST(Tetrahedralize, EveryCellHasAVertexInside) {
  const CellMesh mesh = tetrahedralize(Solid(shapes::box({0, 0, 0}, {1, 1, 0.3})), across(20));
  std::vector<bool> outer(mesh.vertices.size());
  for (const Triangle& t : boundaryTriangles(mesh))
    for (const int v : t) outer[v] = true;
  for (const Tetrahedron& t : mesh.tetrahedra)
    EXPECT_TRUE(std::any_of(t.begin(), t.end(), [&](int v) { return !outer[v]; }));
  std::vector<bool> used(mesh.vertices.size());
  for (const Tetrahedron& t : mesh.tetrahedra)
    for (const int v : t) used[v] = true;
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
}

TEST(Tetrahedralize, AnEdgeIsALatticeCell) {
  const Solid solid(shapes::icosphere(3));
  TetrahedralizeSettings settings;
  settings.edge = 0.1;
  const CellMesh mesh = tetrahedralize(solid, settings);
  // Twelve tetrahedra fill a cell; more, smaller ones along the surface.
  const double inCells = 12 * solid.volume() / 1e-3;
  EXPECT_GT(static_cast<double>(mesh.tetrahedra.size()), inCells);
  EXPECT_LT(static_cast<double>(mesh.tetrahedra.size()), 1.5 * inCells);
}

TEST(Tetrahedralize, UnitsDoNotMatter) {
  const Solid solid(shapes::icosphere(3));
  const CellMesh mesh = tetrahedralize(solid, across(16));
  for (const double scale : {1e-9, 1e6}) {
    const Solid other(shapes::transformed(shapes::icosphere(3), scale, {}));
    const CellMesh scaled = tetrahedralize(other, across(16));
    expectWellShaped(scaled);
    EXPECT_NEAR(static_cast<double>(scaled.tetrahedra.size()),
                static_cast<double>(mesh.tetrahedra.size()), 20);
    EXPECT_NEAR(volumeOf(scaled) / solid.volume(), std::pow(scale, 3), 0.02 * std::pow(scale, 3));
  }
}

TEST(Tetrahedralize, ThreadsDoNotMatter) {
  const Solid solid(shapes::torus(64, 32));
  const CellMesh many = tetrahedralize(solid, across(40));
  const ThreadLimit one(1);
  const CellMesh few = tetrahedralize(solid, across(40));
  ASSERT_EQ(many.tetrahedra, few.tetrahedra);
  for (std::size_t v = 0; v < many.vertices.size(); ++v)
    EXPECT_EQ(squaredNorm(many.vertices[v] - few.vertices[v]), 0);
}

TEST(Tetrahedralize, RefusesNonsenseAndCancels) {
  const Solid solid(shapes::icosphere(2));
  EXPECT_THROW(tetrahedralize(solid, across(3)), SettingError);
  EXPECT_THROW(tetrahedralize(solid, across(2000)), SettingError);
  TetrahedralizeSettings settings;
  settings.edge = 1;
  EXPECT_THROW(tetrahedralize(solid, settings), SettingError);
  settings.edge = -0.1;
  EXPECT_THROW(tetrahedralize(solid, settings), SettingError);
  Progress progress;
  progress.cancel();
  settings = across(32);
  settings.progress = &progress;
  EXPECT_THROW(tetrahedralize(solid, settings), Cancelled);
}

}  // namespace
}  // namespace innermap
