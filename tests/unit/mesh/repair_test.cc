#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "core/expect.h"
#include "core/pi.h"
#include "core/random.h"
#include "innermap/core/error.h"
#include "innermap/mesh/check.h"
#include "innermap/mesh/mesh_file.h"
#include "mesh/test_meshes.h"
#include "mesh/winding_number.h"

namespace innermap {
namespace {

using testing::cube;
using testing::unbalancedEdges;

double windingAt(const Mesh& mesh, const Vec3& p) {
  return WindingNumber(mesh.vertices, mesh.triangles).exactAt(p);
}

// What every repaired mesh must be.
void expectSound(const RepairedMesh& repaired, const Mesh& input) {
  validate(repaired.mesh);
  EXPECT_TRUE(unbalancedEdges(repaired.mesh).empty());
  EXPECT_GT(signedVolume(repaired.mesh), 0);
  ASSERT_EQ(repaired.parent.size(), repaired.mesh.triangles.size());
  ASSERT_EQ(repaired.mesh.vertices.size(), input.vertices.size() + repaired.capVertices.size());
  for (const CapVertex& cap : repaired.capVertices) {
    double sum = 0;
    for (const auto& [vertex, weight] : cap.weights) {
      EXPECT_GE(weight, 0);
      EXPECT_LT(vertex, static_cast<int>(input.vertices.size()));
      sum += weight;
    }
    EXPECT_NEAR(sum, 1, 1e-12);
  }
  const Points again = repairedPositions(repaired, input.vertices);
  for (std::size_t v = 0; v < again.size(); ++v)
    EXPECT_EQ(norm(again[v] - repaired.mesh.vertices[v]), 0);
}

TEST(Repair, CleanMeshesStayAsTheyAre) {
  for (const Mesh& mesh : {cube(), shapes::icosphere(3), shapes::torus(20, 10)}) {
    const RepairedMesh repaired = repair(mesh);
    expectSound(repaired, mesh);
    EXPECT_EQ(repaired.mesh.triangles, mesh.triangles);
    EXPECT_TRUE(repaired.notes.empty());
    EXPECT_EQ(repaired.caps, 0);
  }
}

TEST(Repair, HolesAreCappedAndTheCapsMove) {
  Mesh mesh = cube();
  mesh.triangles.erase(mesh.triangles.begin() + 2, mesh.triangles.begin() + 4);  // the top
  const RepairedMesh repaired = repair(mesh);
  expectSound(repaired, mesh);
  EXPECT_EQ(repaired.caps, 1);
  ASSERT_EQ(repaired.capVertices.size(), 1u);
  EXPECT_NEAR(norm(repaired.mesh.vertices[8] - Vec3{0.5, 0.5, 1}), 0, 1e-15);
  EXPECT_EQ(std::count(repaired.parent.begin(), repaired.parent.end(), -1), 4);
  EXPECT_NEAR(signedVolume(repaired.mesh), 1, 1e-14);
  EXPECT_EQ(repaired.notes, (std::vector<std::string>{"1 hole capped"}));
  Points moved = mesh.vertices;
  for (Vec3& p : moved) p = 3.0 * p + Vec3{1, 2, 3};
  EXPECT_NEAR(norm(repairedPositions(repaired, moved)[8] - Vec3{2.5, 3.5, 6}), 0, 1e-14);
  moved.pop_back();
  EXPECT_THROW(repairedPositions(repaired, moved), DataError);
}

TEST(Repair, AHoleOfThreeEdgesGetsItsTriangleBack) {
  const Mesh whole = shapes::icosphere(2);
  Mesh mesh = whole;
  mesh.triangles.erase(mesh.triangles.begin() + 10);
  const RepairedMesh repaired = repair(mesh);
  expectSound(repaired, mesh);
  EXPECT_TRUE(repaired.capVertices.empty());
  EXPECT_NEAR(signedVolume(repaired.mesh), signedVolume(whole), 1e-14);
}

TEST(Repair, OrientationIsMadeConsistentAndOutward) {
  for (int seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(seed);
    const CounterRandom random(seed, 2);
    Mesh mesh = shapes::torus(16, 8);
    mesh.colours.assign(mesh.vertices.size(), {1, 0, 0});
    mesh.uvs = {{0, 0}, {1, 0}, {0, 1}};
    mesh.uvTriangles.assign(mesh.triangles.size(), {0, 1, 2});
    const double volume = signedVolume(mesh), share = random.uniform(1000);
    const std::vector<Triangle> original = mesh.triangles;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      if (random.uniform(t) < share) {
        std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
        std::swap(mesh.uvTriangles[t][1], mesh.uvTriangles[t][2]);
      }
    const RepairedMesh repaired = repair(mesh);
    expectSound(repaired, mesh);
    EXPECT_EQ(repaired.mesh.triangles, original);
    for (const Triangle& uv : repaired.mesh.uvTriangles) EXPECT_EQ(uv, (Triangle{0, 1, 2}));
    EXPECT_NEAR(signedVolume(repaired.mesh), volume, 1e-12);
  }
}

TEST(Repair, CavitiesStayAndInvertedPartsAreTurned) {
  const Mesh outer = shapes::icosphere(2, 1), hole = shapes::flipped(shapes::icosphere(2, 0.5));
  const Mesh aside = shapes::icosphere(2, 0.25, {3, 0, 0});
  for (const bool insideOut : {false, true})
    for (const bool asideTurned : {false, true}) {
      SCOPED_TRACE(insideOut);
      SCOPED_TRACE(asideTurned);
      Mesh mesh = shapes::joined(outer, hole);
      if (insideOut) mesh = shapes::flipped(mesh);
      mesh = shapes::joined(mesh, asideTurned ? shapes::flipped(aside) : aside);
      const RepairedMesh repaired = repair(mesh);
      expectSound(repaired, mesh);
      EXPECT_NEAR(windingAt(repaired.mesh, {0.75, 0, 0.01}), 1, 1e-9);
      EXPECT_NEAR(windingAt(repaired.mesh, {0.1, 0, 0.01}), 0, 1e-9);
      EXPECT_NEAR(windingAt(repaired.mesh, {3, 0, 0.01}), 1, 1e-9);
      EXPECT_EQ(repaired.notes.empty(), !insideOut && !asideTurned);
    }
}

TEST(Repair, ASolidInsideACavityInsideASolid) {
  Mesh mesh = shapes::joined(shapes::icosphere(2, 4), shapes::flipped(shapes::icosphere(2, 3)));
  mesh = shapes::joined(mesh, shapes::icosphere(2, 2));
  mesh = shapes::joined(mesh, shapes::flipped(shapes::icosphere(2, 1)));
  const RepairedMesh repaired = repair(mesh);
  EXPECT_TRUE(repaired.notes.empty());
  EXPECT_EQ(repaired.mesh.triangles, mesh.triangles);
}

TEST(Repair, DuplicatesAndOppositesDoNotChangeTheSolid) {
  Mesh mesh = cube();
  const auto [a, b, c] = mesh.triangles[7];
  mesh.triangles.push_back({b, c, a});  // duplicate
  mesh.triangles.push_back({b, a, c});  // its opposite: one of them fills a place
  mesh.triangles.push_back({a, a, b});
  mesh.vertices.push_back({0.5, 0.5, 3});
  mesh.vertices.push_back({7, 7, 7});
  mesh.triangles.push_back({0, 1, 8});  // a fin of two faces
  mesh.triangles.push_back({1, 0, 8});
  const RepairedMesh repaired = repair(mesh);
  expectSound(repaired, mesh);
  EXPECT_EQ(repaired.mesh.triangles, cube().triangles);
  EXPECT_EQ(repaired.caps, 0);
  EXPECT_EQ(repaired.notes.size(), 4u);  // loose, repeated, duplicates, pair
}

TEST(Repair, AWallInsideEnclosesNothing) {
  Mesh mesh = cube();  // vertices 0..7: x is bit 0, y bit 1, z bit 2
  mesh.triangles.push_back({0, 1, 7});
  mesh.triangles.push_back({0, 7, 6});
  const RepairedMesh repaired = repair(mesh);
  expectSound(repaired, mesh);
  EXPECT_NEAR(signedVolume(repaired.mesh), 1, 1e-14);
  for (const Vec3 p : {Vec3{0.5, 0.2, 0.7}, Vec3{0.5, 0.7, 0.2}})
    EXPECT_NEAR(windingAt(repaired.mesh, p), 1, 1e-9);
}

TEST(Repair, CubesThatShareAnEdgeAreTurnedOneByOne) {
  Mesh mesh = shapes::joined(cube(), shapes::flipped(cube(1, {1, 1, 0})));
  for (Triangle& t : mesh.triangles)  // the edge x = y = 1: vertices 3 and 7, 8 and 12
    for (int& v : t) v = v == 8 ? 3 : v == 12 ? 7 : v;
  const RepairedMesh repaired = repair(mesh);
  expectSound(repaired, mesh);
  EXPECT_NEAR(signedVolume(repaired.mesh), 2, 1e-14);
}

TEST(Repair, SeamsAreJoinedNotCapped) {
  const Mesh mesh = testing::exploded(shapes::icosphere(2));
  const RepairedMesh repaired = repair(mesh);
  expectSound(repaired, mesh);
  EXPECT_EQ(repaired.caps, 0);
  EXPECT_EQ(repaired.mesh.triangles, mesh.triangles);
  // An open mesh given twice, vertices and all, is two open meshes, not one that cancels.
  Mesh open = cube();
  open.triangles.erase(open.triangles.begin() + 2, open.triangles.begin() + 4);
  const RepairedMesh twice = repair(shapes::joined(open, open));
  EXPECT_NEAR(windingAt(twice.mesh, {0.5, 0.4, 0.3}), 2, 1e-9);
}

TEST(Repair, AMoebiusStripIsRefusedByName) {
  Mesh mesh;
  constexpr int kCount = 30;
  for (int i = 0; i < kCount; ++i)
    for (const double s : {-0.3, 0.3}) {
      const double a = 2 * kPi * i / kCount, r = 1 + s * std::cos(a / 2);
      mesh.vertices.push_back({r * std::cos(a), r * std::sin(a), s * std::sin(a / 2)});
    }
  for (int i = 0; i < kCount; ++i) {
    const bool last = i + 1 == kCount;
    const int a = 2 * i, b = a + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {a, d, c}});
  }
  EXPECT_THROW(repair(mesh), DataError);
  const std::vector<Finding> found = findings(checkMesh(mesh));
  EXPECT_TRUE(std::any_of(found.begin(), found.end(),
                          [](const Finding& f) { return f.name == "one_sided"; }));
}

TEST(Repair, FarApartAndThinIsAnInside) {
  Mesh two = shapes::icosphere(2);
  const int count = static_cast<int>(two.vertices.size());
  const Mesh one = two;
  for (const Vec3& p : one.vertices) two.vertices.push_back(p + Vec3{1e6, 0, 0});
  for (const Triangle& t : one.triangles)
    two.triangles.push_back({t[0] + count, t[1] + count, t[2] + count});
  EXPECT_NO_THROW(repair(two));
  Mesh needle = one, plate = one;
  for (Vec3& p : needle.vertices) p.x *= 1e5;
  for (Vec3& p : plate.vertices) p.x *= 1e-9;
  EXPECT_NO_THROW(repair(needle));
  EXPECT_NO_THROW(repair(plate));
}

TEST(Repair, WhatCannotBeComputedIsSaid) {
  for (const double scale : {1e200, 1e103, 1e-110}) {
    Mesh mesh = shapes::icosphere(1);
    for (Vec3& p : mesh.vertices) p = scale * p;
    EXPECT_THROW(repair(mesh), DataError);
    EXPECT_EQ(findings(checkMesh(mesh)).front().name, "not_computable");
  }
}

TEST(Repair, MeshesWithoutInsideAreRefused) {
  const auto refuse = [](const Mesh& mesh) {
    return test::refusalOf<DataError>([&] { repair(mesh); });
  };
  EXPECT_NE(refuse(Mesh{}), "accepted");
  EXPECT_NE(refuse(testing::makeMesh({{}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}})), "accepted");
  EXPECT_NE(refuse(testing::makeMesh({{}, {1, 0, 0}}, {{0, 1, 1}})), "accepted");
  Mesh flat = cube();
  for (Vec3& p : flat.vertices) p.z *= 1e-12;
  EXPECT_NE(refuse(flat), "accepted");
  Mesh bad = cube();
  bad.vertices[3].x = NAN;
  EXPECT_NE(refuse(bad), "accepted");
}

TEST(Repair, ScaleAndPlaceDoNotMatter) {
  Mesh mesh =
      shapes::joined(shapes::icosphere(2), shapes::flipped(shapes::icosphere(1, 0.2, {2, 0, 0})));
  mesh.triangles.erase(mesh.triangles.begin() + 5, mesh.triangles.begin() + 12);
  const RepairedMesh reference = repair(mesh);
  for (const auto& [scale, shift] : {std::pair{1e-20, 0.0}, {1e20, 0.0}, {1.0, 1e6}, {1e-3, 1e3}}) {
    SCOPED_TRACE(scale);
    const RepairedMesh moved = repair(shapes::transformed(mesh, scale, {shift, -shift, shift}));
    EXPECT_EQ(moved.mesh.triangles, reference.mesh.triangles);
    EXPECT_EQ(moved.notes, reference.notes);
  }
}

// Any soup at all: either no inside, or whole winding numbers everywhere.
TEST(Repair, RandomSoupsHaveWholeWindingNumbers) {
  int solids = 0;
  for (int seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    const CounterRandom random(seed, 4);
    Mesh mesh;
    const int vertices = 4 + seed % 12;
    for (int v = 0; v < vertices; ++v) mesh.vertices.push_back(shapes::randomPoint(random, v));
    const int count = 1 + static_cast<int>(random.bits(100) % 40);
    for (int t = 0; t < count; ++t)
      for (int c = (mesh.triangles.emplace_back(), 0); c < 3; ++c)
        mesh.triangles.back()[c] =
            static_cast<int>(random.bits(200 + 3 * t + c) % static_cast<unsigned>(vertices));
    try {
      const RepairedMesh repaired = repair(mesh);
      expectSound(repaired, mesh);
      ++solids;
      for (int k = 0; k < 10; ++k) {
        const double w = windingAt(repaired.mesh, shapes::randomPoint(random, 1000 + k));
        EXPECT_NEAR(w, std::round(w), 1e-6);
      }
    } catch (const DataError&) {
    }
  }
  EXPECT_GT(solids, 200);
}

TEST(Repair, CanBeCancelled) {
  test::expectCancels([&] { repair(cube()); });
}

TEST(RepairModels, AreSensibleSolids) {
  const std::string folder = INNERMAP_MODELS;
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  struct Known {
    const char* file;
    int caps;
  };
  for (const Known& known : {Known{"stanford-bunny", 5}, Known{"teapot", 6},
                             Known{"horse-poses/reference", 2}, Known{"suzanne", 4}}) {
    SCOPED_TRACE(known.file);
    const Mesh mesh = readMesh(folder + "/" + known.file + ".obj");
    const RepairedMesh repaired = repair(mesh);
    EXPECT_TRUE(unbalancedEdges(repaired.mesh).empty());
    EXPECT_EQ(repaired.caps, known.caps);
    EXPECT_GT(signedVolume(repaired.mesh), 0.01 * std::pow(boundingBox(mesh).diagonal(), 3));
    // Winding numbers are whole and never negative; the volume is that of the points inside.
    const WindingNumber winding(repaired.mesh.vertices, repaired.mesh.triangles);
    const Box3 box = boundingBox(repaired.mesh);
    const CounterRandom random(1, 1);
    const int count = 4000;
    double sum = 0;
    for (int k = 0; k < count; ++k) {
      Vec3 p = shapes::randomPoint(random, k);
      for (int a = 0; a < 3; ++a) p[a] = box.center()[a] + 0.5 * p[a] * box.extent()[a];
      const double w = winding.at(p);
      EXPECT_NEAR(w, std::round(w), 0.02);
      EXPECT_GT(w, -0.5);
      sum += std::round(w) / count;
    }
    const double volume = box.extent().x * box.extent().y * box.extent().z;
    // Four standard deviations of a count.
    EXPECT_NEAR(sum, signedVolume(repaired.mesh) / volume, 4 * std::sqrt(0.5 / count));
  }
}

}  // namespace
}  // namespace innermap
