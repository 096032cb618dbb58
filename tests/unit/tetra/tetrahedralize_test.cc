#include "innermap/tetra/tetrahedralize.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "innermap/tetra/cells.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

TetrahedralizeSettings across(int resolution) { return {.resolution = resolution}; }

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
  Shell shell{.euler = static_cast<long>(vertices.size()) - static_cast<long>(edges.size()) +
                       static_cast<long>(boundary.size())};
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

// Two slabs that are joined along one side, `gap` apart: a lattice coarser than that joins them.
Mesh clamp(double gap) {
  const double a = 0.5 - 0.5 * gap, b = 0.5 + 0.5 * gap;
  Mesh mesh{.name = "clamp"};
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

TEST(TetrahedralizeRelease, NarrowGapsStayOpen) {
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

}  // namespace
}  // namespace innermap
