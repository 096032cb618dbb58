#include "innermap/mesh/check.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/expect.h"
#include "core/random.h"
#include "innermap/core/error.h"
#include "innermap/mesh/mesh_file.h"
#include "mesh/test_meshes.h"

namespace innermap {
namespace {

using testing::cube;

std::vector<std::string> namesOf(const MeshReport& report) {
  std::vector<std::string> names;
  for (const Finding& finding : findings(report)) {
    names.push_back(finding.name);
    EXPECT_GT(finding.count, 0u);
    EXPECT_FALSE(finding.what.empty());
    EXPECT_FALSE(finding.meaning.empty());
    EXPECT_EQ((finding.what + finding.meaning).find('\n'), std::string::npos);
  }
  return names;
}

using Names = std::vector<std::string>;

TEST(Check, CleanMeshesHaveNoFindings) {
  for (const Mesh& mesh : {cube(), shapes::icosphere(3), shapes::torus(30, 12)}) {
    const MeshReport report = checkMesh(mesh);
    EXPECT_EQ(namesOf(report), Names{}) << mesh.name;
    EXPECT_EQ(report.components, 1);
    EXPECT_TRUE(report.closed);
    EXPECT_TRUE(report.outward);
    EXPECT_NEAR(report.volume, signedVolume(mesh), 1e-14);
    EXPECT_NEAR(report.area, surfaceArea(mesh), 1e-14);
  }
  EXPECT_EQ(checkMesh(cube()).genus, 0);
  EXPECT_EQ(checkMesh(shapes::torus(30, 12)).genus, 1);
}

TEST(Check, BoundaryLoopsWithTheirLengths) {
  Mesh mesh = cube();
  mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + 4);  // bottom and top
  const MeshReport report = checkMesh(mesh);
  EXPECT_EQ(namesOf(report), Names{"boundary_loops"});
  ASSERT_EQ(report.boundaryLoops.size(), 2u);
  for (const BoundaryLoop& loop : report.boundaryLoops) {
    EXPECT_EQ(loop.vertices.size(), 4u);
    EXPECT_NEAR(loop.length, 4, 1e-14);
  }
  EXPECT_EQ(report.openLoops, 2u);
  EXPECT_NEAR(report.volume, 1, 1e-14);  // flat caps
  EXPECT_EQ(report.genus, 0);
  EXPECT_FALSE(report.closed);
}

TEST(Check, LoopsThatMeetInAVertexAreTwo) {
  // A 3 x 3 grid of quads without two that touch in a corner.
  Mesh mesh;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) mesh.vertices.push_back({double(x), double(y), 0});
  for (int i = 0; i < 9; ++i) {
    if (i == 4 || i == 8) continue;
    const int a = i % 3 + 4 * (i / 3);
    mesh.triangles.insert(mesh.triangles.end(), {{a, a + 1, a + 5}, {a, a + 5, a + 4}});
  }
  const MeshReport report = checkMesh(mesh);
  ASSERT_EQ(report.boundaryLoops.size(), 2u);
  EXPECT_EQ(report.boundaryLoops[0].vertices.size() + report.boundaryLoops[1].vertices.size(), 16u);
  EXPECT_EQ(report.nonManifoldVertices, (std::vector<int>{10}));
}

TEST(Check, OrientationAndInsideOut) {
  Mesh mesh = cube();
  std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
  EXPECT_EQ(checkMesh(mesh).inconsistentEdges, 3u);
  EXPECT_EQ(namesOf(checkMesh(mesh)), Names{"inconsistent_orientation"});
  const MeshReport report = checkMesh(shapes::flipped(cube()));
  EXPECT_FALSE(report.outward);
  EXPECT_NEAR(report.volume, -1, 1e-14);
  EXPECT_EQ(namesOf(report), Names{"inside_out"});
}

TEST(Check, DuplicateOppositeAndDegenerateTriangles) {
  Mesh mesh = cube();
  const auto [a, b, c] = mesh.triangles[7];
  mesh.triangles.push_back({b, c, a});      // 12: duplicate
  mesh.triangles.push_back({b, a, c});      // 13: opposite
  mesh.triangles.push_back({c, b, a});      // 14: opposite, and repeats 13
  mesh.triangles.push_back({a, a, b});      // 15: repeated vertex
  mesh.vertices.push_back({0.5, 0.5, -1});  // 8, 9, 10 in a line
  mesh.vertices.push_back({0.5, 0.5, -2});
  mesh.vertices.push_back({0.5, 0.5, -3});
  mesh.triangles.push_back({8, 9, 10});  // 16
  const MeshReport report = checkMesh(mesh);
  EXPECT_EQ(report.duplicateTriangles, (std::vector<int>{12, 14}));
  EXPECT_EQ(report.oppositeTriangles, (std::vector<int>{13}));
  EXPECT_EQ(report.degenerateTriangles, (std::vector<int>{15, 16}));
  EXPECT_EQ(report.nonManifoldEdges.size(), 3u);
}

TEST(Check, DegeneracyIsRelativeToTheSize) {
  for (const double scale : {1e-30, 1.0, 1e30})
    EXPECT_TRUE(checkMesh(shapes::icosphere(2, scale)).degenerateTriangles.empty());
}

TEST(Check, ComponentsLooseVerticesAndContacts) {
  Mesh mesh = shapes::joined(cube(), cube(1, {5, 0, 0}));
  mesh.vertices.push_back({100, 0, 0});
  MeshReport report = checkMesh(mesh);
  EXPECT_EQ(report.components, 2);
  EXPECT_EQ(report.genus, 0);
  EXPECT_EQ(report.looseVertices, (std::vector<int>{16}));
  EXPECT_LT(report.box.diagonal(), 10);
  EXPECT_EQ(namesOf(report), (Names{"components", "loose_vertices"}));

  // Two cubes that share vertex 7 only.
  mesh = shapes::joined(cube(), cube(1, {1, 1, 1}));
  for (Triangle& t : mesh.triangles)
    for (int& v : t) v = v == 8 ? 7 : v;
  report = checkMesh(mesh);
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(report.nonManifoldVertices, (std::vector<int>{7}));
  EXPECT_EQ(report.genus, 0);
}

TEST(Check, SeamsAreNoHoles) {
  const Mesh mesh = testing::exploded(shapes::torus(20, 10));
  const MeshReport report = checkMesh(mesh);
  EXPECT_EQ(report.boundaryLoops.size(), mesh.triangles.size());
  EXPECT_EQ(report.seamEdges, 3 * mesh.triangles.size() / 2);
  EXPECT_EQ(report.openLoops, 0u);
  EXPECT_EQ(report.genus, 1);
  EXPECT_NEAR(report.volume, signedVolume(mesh), 1e-12);
}

TEST(Check, SheetsHaveNoInside) {
  const Mesh sheet =
      testing::makeMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {1, 3, 2}});
  EXPECT_EQ(namesOf(checkMesh(sheet)).front(), "no_inside");
  EXPECT_EQ(namesOf(checkMesh(Mesh{})).front(), "no_inside");
}

TEST(Check, SelfIntersectionsAreListedInOrder) {
  const Mesh mesh = shapes::joined(shapes::icosphere(2), shapes::icosphere(2, 1, {0.7, 0, 0}));
  const MeshReport report = checkMesh(mesh, {.listed = 5});
  EXPECT_GT(report.selfIntersections, 20u);
  ASSERT_EQ(report.crossings.size(), 5u);
  for (std::size_t k = 1; k < 5; ++k)
    EXPECT_LE(report.crossings[k - 1].first, report.crossings[k].first);
  EXPECT_EQ(namesOf(report), (Names{"self_intersections", "components"}));
  EXPECT_EQ(checkMesh(mesh, {.selfIntersections = false, .listed = 5}).selfIntersections, 0u);
  EXPECT_EQ(checkMesh(mesh, {.selfIntersections = true, .listed = 0}).selfIntersections,
            report.selfIntersections);
}

TEST(Check, RefusesInvalidMeshesAndCancels) {
  Mesh mesh = cube();
  mesh.triangles[0][0] = 99;
  EXPECT_THROW(checkMesh(mesh), DataError);
  test::expectCancels([&] { checkMesh(cube(), {}); });
}

TEST(Check, RandomSoupsDoNotBreakIt) {
  for (int seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    const CounterRandom random(seed, 9);
    Mesh mesh;
    for (int v = 0; v < 8; ++v)
      for (int a = (mesh.vertices.emplace_back(), 0); a < 3; ++a)
        mesh.vertices.back()[a] = static_cast<double>(random.bits(3 * v + a) % 3);
    const int count = static_cast<int>(random.bits(100) % 40);
    for (int t = 0; t < count; ++t)
      for (int c = (mesh.triangles.emplace_back(), 0); c < 3; ++c)
        mesh.triangles.back()[c] = static_cast<int>(random.bits(200 + 3 * t + c) % 8);
    const MeshReport report = checkMesh(mesh);
    for (const BoundaryLoop& loop : report.boundaryLoops) EXPECT_GE(loop.vertices.size(), 3u);
    findings(report);
  }
}

TEST(CheckModels, WhatIsKnownOfThem) {
  const std::string folder = INNERMAP_MODELS;
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  struct Known {
    const char* file;
    int components;
    std::size_t openLoops, loose;
    int genus;
  };
  for (const Known& known :
       {Known{"spot", 1, 0, 0, 0}, Known{"homer", 1, 0, 0, 0}, Known{"rocker-arm", 1, 0, 0, 1},
        Known{"stanford-bunny", 1, 5, 1113, 0}, Known{"suzanne", 3, 4, 0, 0},
        Known{"teapot", 4, 6, 0, 0}, Known{"horse-poses/reference", 1, 2, 0, 0}}) {
    SCOPED_TRACE(known.file);
    const MeshReport report = checkMesh(readMesh(folder + "/" + known.file + ".obj"));
    EXPECT_EQ(report.components, known.components);
    EXPECT_EQ(report.openLoops, known.openLoops);
    EXPECT_EQ(report.looseVertices.size(), known.loose);
    EXPECT_EQ(report.genus, known.genus);
    EXPECT_TRUE(report.outward);
  }
  // Counted with rational arithmetic, pairs that only touch left out.
  EXPECT_EQ(checkMesh(readMesh(folder + "/horse-poses/pose-03.obj")).selfIntersections, 51u);
  EXPECT_EQ(checkMesh(readMesh(folder + "/horse-poses/pose-01.obj")).selfIntersections, 59u);
}

TEST(Check, MemoryGrowsWithTheMesh) {
  EXPECT_EQ(checkMemory(Mesh()), 0u);
  const Mesh ball = shapes::icosphere(3);
  EXPECT_GT(checkMemory(ball), 300 * ball.triangles.size());
}

}  // namespace
}  // namespace innermap
