#include <gtest/gtest.h>

#include <map>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/mesh/mesh_file.h"
#include "innermap/surface/correspond.h"
#include "mesh/test_meshes.h"

namespace innermap {
namespace {

using testing::cube;
using testing::makeMesh;

// What every result must be.
void expectSound(const SurfaceShells& surfaces) {
  validate(surfaces.mesh);
  ASSERT_EQ(surfaces.parent.size(), surfaces.shells.size());
  ASSERT_EQ(surfaces.meshTriangle.size(), surfaces.shells.size());
  ASSERT_EQ(surfaces.shellVertex.size(), surfaces.mesh.vertices.size());
  ASSERT_EQ(surfaces.turned.size(), surfaces.mesh.triangles.size());
  for (std::size_t s = 0; s < surfaces.shells.size(); ++s) {
    const ClosedSurface& shell = surfaces.shells[s];
    std::map<std::array<int, 2>, int> sides;
    std::vector<bool> used(shell.vertices.size(), false);
    ASSERT_EQ(surfaces.meshTriangle[s].size(), shell.triangles.size());
    for (std::size_t t = 0; t < shell.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const int v = shell.triangles[t][k];
        used[v] = true;
        ++sides[{v, shell.triangles[t][(k + 1) % 3]}];
        const int m = surfaces.mesh.triangles[surfaces.meshTriangle[s][t]][k];
        EXPECT_EQ(surfaces.shellVertex[m].shell, static_cast<int>(s));
        EXPECT_EQ(surfaces.shellVertex[m].vertex, v);
        EXPECT_EQ(norm(surfaces.mesh.vertices[m] - shell.vertices[v]), 0);
      }
    for (const auto& [side, count] : sides) {
      EXPECT_EQ(count, 1);
      EXPECT_EQ(sides.count({side[1], side[0]}), 1u);
    }
    for (const bool u : used) EXPECT_TRUE(u);
    const long euler = static_cast<long>(shell.vertices.size()) -
                       static_cast<long>(sides.size() / 2) +
                       static_cast<long>(shell.triangles.size());
    EXPECT_EQ(euler, 2 - 2 * shell.genus);
  }
}

double volumeOf(const ClosedSurface& shell) {
  return signedVolume(makeMesh(shell.vertices, shell.triangles));
}

std::string messageOf(const Mesh& mesh, bool closeHoles = false) {
  return test::refusalOf<DataError>([&] { closedSurfaces(mesh, {.closeHoles = closeHoles}); });
}

void expectSays(const std::string& message, const std::string& part) {
  EXPECT_NE(message.find(part), std::string::npos) << message;
}

// Two cubes grown together at the corner (1, 1, 1), which is one vertex.
Mesh touchingCubes() {
  Mesh mesh = shapes::joined(cube(), cube(1, {1, 1, 1}));
  for (Triangle& t : mesh.triangles)
    for (int& v : t)
      if (v == 8) v = 7;
  return mesh;
}

TEST(ClosedSurfaces, CleanMeshesStayAsTheyAre) {
  for (const auto& [mesh, genus] : {std::pair(cube(), 0), std::pair(shapes::icosphere(3), 0),
                                    std::pair(shapes::torus(9, 7), 1)}) {
    const SurfaceShells surfaces = closedSurfaces(mesh);
    expectSound(surfaces);
    ASSERT_EQ(surfaces.shells.size(), 1u);
    EXPECT_EQ(surfaces.shells[0].triangles, mesh.triangles);
    EXPECT_EQ(surfaces.shells[0].genus, genus);
    EXPECT_EQ(surfaces.shells[0].name, mesh.name);
    EXPECT_EQ(surfaces.mesh.triangles, mesh.triangles);
    EXPECT_EQ(surfaces.parent[0], -1);
    EXPECT_EQ(surfaces.caps, 0);
    EXPECT_TRUE(surfaces.notes.empty());
  }
}

TEST(ClosedSurfaces, SeamsAreJoined) {
  const SurfaceShells surfaces = closedSurfaces(testing::exploded(shapes::torus(9, 7)));
  expectSound(surfaces);
  ASSERT_EQ(surfaces.shells.size(), 1u);
  EXPECT_EQ(surfaces.shells[0].vertices.size(), 63u);
  EXPECT_EQ(surfaces.shells[0].genus, 1);
  EXPECT_EQ(surfaces.splitVertices, 0u);
}

TEST(ClosedSurfaces, OrientationIsMadeOutwardAndTold) {
  Mesh mesh = shapes::flipped(shapes::icosphere(2));
  std::swap(mesh.triangles[5][1], mesh.triangles[5][2]);
  const SurfaceShells surfaces = closedSurfaces(mesh);
  expectSound(surfaces);
  EXPECT_GT(volumeOf(surfaces.shells[0]), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    EXPECT_EQ(surfaces.turned[t], t != 5) << t;
}

TEST(ClosedSurfaces, HolesAreRefusedOrClosed) {
  Mesh mesh = shapes::icosphere(2);
  mesh.triangles.erase(mesh.triangles.begin());
  mesh.triangles.erase(mesh.triangles.begin() + 99, mesh.triangles.begin() + 103);
  expectSays(messageOf(mesh), "is open, with 2 holes, the longest");
  const SurfaceShells surfaces = closedSurfaces(mesh, {.closeHoles = true});
  expectSound(surfaces);
  EXPECT_EQ(surfaces.caps, 2);
  ASSERT_EQ(surfaces.shells.size(), 1u);
  EXPECT_EQ(surfaces.shells[0].genus, 0);
  EXPECT_EQ(surfaces.mesh.vertices.size(), mesh.vertices.size() + 1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    EXPECT_EQ(surfaces.mesh.triangles[t], mesh.triangles[t]);
}

TEST(ClosedSurfaces, CrowdedEdgesAreNamed) {
  Mesh mesh = cube();
  mesh.vertices.push_back({2, 2, 2});
  mesh.triangles.push_back({3, 7, 8});
  const std::string message = messageOf(mesh, true);
  expectSays(message, "1 edge has more than two triangles");
  expectSays(message, "3-7");
}

TEST(ClosedSurfaces, OneSidedSurfacesAreRefused) {
  // A Moebius strip of five squares, with a tetrahedron that has an inside.
  Mesh mesh{.name = "strip"};
  for (int i = 0; i < 5; ++i) {
    const double a = 2 * kPi * i / 5, h = a / 2;
    for (const double side : {-0.3, 0.3}) {
      const double r = 1 + side * std::cos(h);
      mesh.vertices.push_back({r * std::cos(a), r * std::sin(a), side * std::sin(h)});
    }
    const int p = 2 * i, q = p + 1, r = i < 4 ? p + 2 : 1, s = i < 4 ? p + 3 : 0;
    mesh.triangles.push_back({p, r, q});
    mesh.triangles.push_back({q, r, s});
  }
  expectSays(messageOf(shapes::joined(mesh, cube(1, {5, 5, 5})), true), "is one-sided");
}

TEST(ClosedSurfaces, SheetsAreRefused) {
  const Mesh square =
      makeMesh({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
  expectSays(messageOf(square, true), "no inside");
  expectSays(messageOf(square, false), "no inside");
}

TEST(ClosedSurfaces, PartsThatEncloseNothingAreLeftOut) {
  Mesh mesh = shapes::joined(shapes::icosphere(2),
                             makeMesh({{3, 0, 0}, {4, 0, 0}, {4, 1, 0}}, {{0, 1, 2}}));
  const SurfaceShells surfaces = closedSurfaces(mesh, {.closeHoles = true});
  expectSound(surfaces);
  EXPECT_EQ(surfaces.shells.size(), 1u);
  EXPECT_EQ(surfaces.shellVertex.back().shell, -1);
}

TEST(ClosedSurfaces, AVertexWherePartsTouchIsSplit) {
  const Mesh mesh = touchingCubes();
  const SurfaceShells surfaces = closedSurfaces(mesh);
  expectSound(surfaces);
  ASSERT_EQ(surfaces.shells.size(), 2u);
  EXPECT_EQ(surfaces.splitVertices, 1u);
  ASSERT_EQ(surfaces.mesh.vertices.size(), mesh.vertices.size() + 1);
  EXPECT_EQ(surfaces.shellVertex[7].shell, 0);
  EXPECT_EQ(surfaces.shellVertex.back().shell, 1);
  EXPECT_EQ(surfaces.shellVertex[8].shell, -1);  // nothing uses it any more
  EXPECT_EQ(surfaces.parent, (std::vector<int>{-1, -1}));
}

TEST(ClosedSurfaces, AShellThatTouchesItselfIsSplitInTwoFans) {
  // A bar bent until the ends' corners are one vertex: genus 0 with a pinch.
  Mesh mesh = shapes::icosphere(3);
  const Vec3 place = 0.5 * (mesh.vertices[0] + mesh.vertices[3]);
  mesh.vertices[0] = place;
  for (Triangle& t : mesh.triangles)
    for (int& v : t)
      if (v == 3) v = 0;
  const SurfaceShells surfaces = closedSurfaces(mesh);
  expectSound(surfaces);
  ASSERT_EQ(surfaces.shells.size(), 1u);
  EXPECT_EQ(surfaces.shells[0].genus, 0);
  EXPECT_EQ(surfaces.splitVertices, 1u);
}

TEST(ClosedSurfaces, NestingIsFoundThroughAllLevels) {
  // A ball, a cavity in it, an island in the cavity; a second ball beside them. Out of order.
  Mesh mesh = shapes::joined(shapes::icosphere(2, 0.3), shapes::icosphere(2, 1, {5, 0, 0}));
  mesh = shapes::joined(mesh, shapes::flipped(shapes::icosphere(2, 0.6)));
  mesh = shapes::joined(mesh, shapes::icosphere(3, 1));
  const SurfaceShells surfaces = closedSurfaces(mesh);
  expectSound(surfaces);
  ASSERT_EQ(surfaces.shells.size(), 4u);
  EXPECT_EQ(surfaces.parent, (std::vector<int>{2, -1, 3, -1}));
  EXPECT_LT(volumeOf(surfaces.shells[2]), 0);
  EXPECT_GT(volumeOf(surfaces.shells[0]), 0);
}

TEST(ClosedSurfaces, OverlappingPartsStaySideBySide) {
  const SurfaceShells surfaces =
      closedSurfaces(shapes::joined(shapes::icosphere(2), shapes::icosphere(2, 0.5, {1, 0, 0})));
  expectSound(surfaces);
  ASSERT_EQ(surfaces.shells.size(), 2u);
  EXPECT_EQ(surfaces.parent, (std::vector<int>{-1, -1}));
}

TEST(ClosedSurfaces, TrianglesWithoutAreaAreKeptDuplicatesAreNot) {
  Mesh mesh = shapes::icosphere(2);
  mesh.vertices[20] = mesh.vertices[mesh.triangles[0][0] == 20 ? 21 : mesh.triangles[0][0]];
  mesh.triangles.push_back(mesh.triangles[7]);
  mesh.triangles.push_back({1, 1, 2});
  mesh.vertices.push_back({9, 9, 9});
  const SurfaceShells surfaces = closedSurfaces(mesh);
  expectSound(surfaces);
  ASSERT_EQ(surfaces.shells.size(), 1u);
  EXPECT_EQ(surfaces.shells[0].triangles.size(), mesh.triangles.size() - 2);
  EXPECT_EQ(surfaces.mesh.triangles.size(), mesh.triangles.size());
  EXPECT_EQ(surfaces.shellVertex.back().shell, -1);
}

TEST(ClosedSurfaces, RealModels) {
  const std::string models = INNERMAP_MODELS;
  const std::map<std::string, int> genus{
      {"spot", 0}, {"homer", 0}, {"cheburashka", 0}, {"fandisk", 0}, {"rocker-arm", 1}};
  for (const auto& [name, expected] : genus) {
    Mesh mesh;
    try {
      mesh = readMesh(models + "/" + name + ".obj");
    } catch (const FileError&) {
      GTEST_SKIP() << "no models at " << models;
    }
    const SurfaceShells surfaces = closedSurfaces(mesh);
    expectSound(surfaces);
    ASSERT_EQ(surfaces.shells.size(), 1u) << name;
    EXPECT_EQ(surfaces.shells[0].genus, expected) << name;
  }
}

TEST(ClosedSurfaces, CanBeCancelled) {
  test::expectCancels([&] { closedSurfaces(cube(), {}); });
}

}  // namespace
}  // namespace innermap
