#include "innermap/tetra/tetrahedralize.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "core/memory_limit.h"
#include "core/pi.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/tetra/cells.h"
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

// Two slabs that are joined along one side, `gap` apart: a lattice coarser than that joins them.
Mesh clamp(double gap) {
  const double a = 0.5 - 0.5 * gap, b = 0.5 + 0.5 * gap;
  Mesh mesh;
  mesh.name = "clamp";
  const double outline[8][2] = {{0, 0}, {1, 0}, {1, a}, {0.2, a}, {0.2, b}, {1, b}, {1, 1}, {0, 1}};
  for (const double z : {0.0, 0.5})
    for (const auto& p : outline) mesh.vertices.push_back({p[0], p[1], z});
  const int caps[6][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 7}, {4, 5, 6}, {4, 6, 7}};
  for (const auto& t : caps) {
    mesh.triangles.push_back({t[0], t[2], t[1]});
    mesh.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  }
  for (int i = 0; i < 8; ++i) {
    const int j = (i + 1) % 8;
    mesh.triangles.push_back({i, j, j + 8});
    mesh.triangles.push_back({i, j + 8, i + 8});
  }
  return mesh;
}

TEST(Tetrahedralize, NarrowGapsStayOpen) {
  for (const int n : {16, 24, 37}) {
    const Tetrahedralization result = tetrahedralization(Solid(clamp(0.3 / n)), across(n));
    expectWellShaped(result.mesh);
    ASSERT_TRUE(result.solidTopology.has_value());
    EXPECT_TRUE(*result.solidTopology == (SolidTopology{1, 0, 0}));
    EXPECT_TRUE(result.topology == *result.solidTopology);
    EXPECT_EQ(shellOf(result.mesh).euler, 2);
    EXPECT_EQ(shellOf(result.mesh).unpaired, 0);
  }
}

TEST(Tetrahedralize, ThinWallsAreNotLost) {
  for (const int n : {12, 20, 31}) {
    const Mesh sheet = shapes::box({0, 0, 0}, {1, 0.8, 0.3 / n});
    const Tetrahedralization result = tetrahedralization(
        Solid(shapes::joined(sheet, shapes::icosphere(3, 0.2, {0.5, 0.4, 3}))), across(n));
    expectWellShaped(result.mesh);
    EXPECT_TRUE(result.topology == (SolidTopology{2, 0, 0}));
    Box3 box;
    for (const Vec3& v : result.mesh.vertices)
      if (v.z < 1) box.add(v);
    const double h = result.edge;
    EXPECT_NEAR(box.upper.x, 1, 1.5 * h);
    EXPECT_NEAR(box.upper.y, 0.8, 1.5 * h);
  }
}

TEST(Tetrahedralize, RefusesWithAResolutionThatWouldDo) {
  // 30 balls in two cells of the lattice.
  Mesh many = shapes::icosphere(2);
  for (int i = 0; i < 30; ++i)
    many = shapes::joined(many, shapes::icosphere(1, 0.01, {0.021 * i, 1.1, 0}));
  const Solid solid(many);
  try {
    tetrahedralize(solid, across(16));
    FAIL() << "31 components at a resolution of 16";
  } catch (const DataError& e) {
    EXPECT_NE(std::string(e.what()).find("31 components"), std::string::npos) << e.what();
  }
  TetrahedralizeSettings settings = across(16);
  settings.keepTopology = false;
  const Tetrahedralization result = tetrahedralization(solid, settings);
  ASSERT_FALSE(result.warnings.empty());
  EXPECT_TRUE(boundaryTopology(result.mesh.vertices, boundaryTriangles(result.mesh)).solid ==
              result.topology);
}

TEST(Tetrahedralize, OpenAndOverlappingMeshes) {
  Mesh open = shapes::icosphere(3);
  open.triangles.resize(open.triangles.size() - 4);
  for (const Mesh& mesh :
       {open, shapes::joined(shapes::icosphere(3), shapes::icosphere(3, 1, {1, 0, 0}))}) {
    const Tetrahedralization result = tetrahedralization(Solid(mesh), across(24));
    expectWellShaped(result.mesh);
    EXPECT_FALSE(result.solidTopology.has_value());
    EXPECT_TRUE(result.warnings.empty());
    EXPECT_EQ(shellOf(result.mesh).euler, 2);
  }
}

TEST(Tetrahedralize, SharpEdgesAreKept) {
  const Solid solid(shapes::box({0, 0, 0}, {1, 0.8, 0.6}));
  TetrahedralizeSettings settings = across(20);
  settings.features = 30;
  const Tetrahedralization result = tetrahedralization(solid, settings);
  EXPECT_EQ(result.sharpCurves, 12u);
  EXPECT_EQ(result.keptCurves, 12u);
  EXPECT_LT(result.sharpMax, 0.3 * result.edge);
  const CellQuality quality = cellQuality(result.mesh);
  EXPECT_EQ(quality.invertedTetrahedra, 0u);
  EXPECT_GE(quality.dihedral.least, 5 - 1e-4);
  EXPECT_LE(quality.greatestAngle, 170 + 1e-4);
  const Tetrahedralization blunt = tetrahedralization(solid, across(20));
  EXPECT_LT(std::abs(volumeOf(result.mesh) - solid.volume()),
            0.3 * std::abs(volumeOf(blunt.mesh) - solid.volume()));
  settings.features = 100;
  EXPECT_EQ(tetrahedralization(solid, settings).sharpCurves, 0u);
  settings.features = 200;
  EXPECT_THROW(tetrahedralization(solid, settings), SettingError);
}

TEST(Tetrahedralize, SaysItsMemory) {
  const Solid solid(shapes::icosphere(3));
  const StuffingNeed need = tetrahedralizeNeed(solid, across(32));
  const CellMesh mesh = tetrahedralize(solid, across(32));
  EXPECT_GE(need.tetrahedra, mesh.tetrahedra.size());
  EXPECT_GE(need.vertices, mesh.vertices.size());
  EXPECT_LT(static_cast<double>(need.tetrahedra),
            1.3 * static_cast<double>(mesh.tetrahedra.size()));
  TetrahedralizeSettings settings = across(1024);
  {
    const MemoryLimit limit(100'000'000);
    EXPECT_THROW(tetrahedralize(solid, settings), MemoryError);
  }
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
  RunContext run;
  run.cancel();
  settings = across(32);
  const RunScope scope(run);
  EXPECT_THROW(tetrahedralize(solid, settings), Cancelled);
}

}  // namespace
}  // namespace innermap
