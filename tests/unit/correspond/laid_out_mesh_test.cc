#include <gtest/gtest.h>

#include "core/expect.h"
#include "core/pi.h"
#include "fit/blobs.h"
#include "innermap/correspond/mesh_correspondence.h"
#include "mesh/test_meshes.h"

namespace innermap {
namespace {

using shapes::blob;
using shapes::joined;
using shapes::opened;
using shapes::overlapping;

bool anyHas(const std::vector<std::string>& lines, const std::string& word) {
  for (const std::string& line : lines)
    if (line.find(word) != std::string::npos) return true;
  return false;
}

TEST(LayOutMesh, TakesACleanMeshAsItIs) {
  const Mesh mesh = blob("a.obj", 2, 0.5);
  const LaidOutMesh laid = layOutMesh(mesh);
  EXPECT_FALSE(laid.outer);
  EXPECT_TRUE(laid.ownNumbers());
  EXPECT_EQ(laid.handles(), 0);
  EXPECT_NEAR(laid.volume(), signedVolume(mesh), 1e-12);
  EXPECT_EQ(laid.mesh.vertices.size(), mesh.vertices.size());
  ASSERT_EQ(laid.seconds.size(), 2u);
  EXPECT_EQ(laid.seconds[0].first, "check");
  EXPECT_EQ(laid.seconds[1].first, "lay out");
}

TEST(LayOutMesh, KnowsTheCapsOfAnOpenMeshThatOverlaps) {
  const LaidOutMesh laid = layOutMesh(opened(overlapping("two.obj"), 6), {.outerResolution = 20});
  ASSERT_TRUE(laid.outer);
  EXPECT_FALSE(laid.caps().empty());
  EXPECT_TRUE(anyHas(laid.notes, "capped"));
}

// A ring of four rods that overlap has a handle as a union; onto a ball it goes as a rod.
TEST(LayOutMeshesRelease, CutsTheUnionOfSeveralPiecesAsTheOtherHas) {
  Mesh ring = joined(
      joined(shapes::box({0, 0, 0}, {4, 1, 1}), shapes::box({0.1, 3.1, 0.1}, {4.1, 4.1, 1.1})),
      joined(shapes::box({0.05, 0.2, 0.2}, {1.05, 3.9, 0.8}),
             shapes::box({2.95, 0.3, 0.15}, {3.95, 3.8, 0.85})));
  ring.name = "ring.obj";
  const Mesh ball = blob("ball.obj", 2, 0.5);
  const auto [a, b] = layOutMeshes(ball, ring, {.outerResolution = 16});
  EXPECT_EQ(a.handles(), 0);
  EXPECT_EQ(b.handles(), 0);
  ASSERT_TRUE(b.outer);
  EXPECT_FALSE(b.outer->cuts.empty());
  EXPECT_TRUE(anyHas(b.notes, "cuts it until it has 0, like ball.obj"));
  const CleanSurface asked = cleanSurface(ring, {.outerResolution = 16, .handles = 1});
  EXPECT_FALSE(asked.handlesOfUnion) << "what is asked for stays";
  EXPECT_EQ(asked.handles, 1);
}

// A coil that closes on itself is a ball still: one piece, whose union with itself is a ring.
TEST(LayOutMeshRelease, KeepsTheHandlesOfAMeshThatRunsThroughItself) {
  const Mesh mesh = shapes::coil(2.2 * kPi);
  const LaidOutMesh laid = layOutMesh(mesh, {.outerResolution = 40});
  ASSERT_TRUE(laid.outer);
  EXPECT_EQ(laid.handles(), 0);
  EXPECT_FALSE(laid.outer->cuts.empty());
  const LaidOutMesh ring = layOutMesh(mesh, {.outerResolution = 40, .handles = 1});
  EXPECT_EQ(ring.handles(), 1);
  EXPECT_TRUE(ring.outer->cuts.empty());
  EXPECT_THROW(layOutMesh(mesh, {.outerResolution = 40, .handles = 3}), DataError);
}

TEST(LayOutMesh, RefusesSettingsOutOfRange) {
  LayOutSettings settings;
  for (const int bad : {-1, 7, 1025}) {
    settings.outerResolution = bad;
    EXPECT_THROW(layOutMesh(overlapping("two.obj"), settings), SettingError) << bad;
  }
}

TEST(LayOutMesh, CanBeCancelled) {
  test::expectCancels([&] { layOutMesh(blob("a.obj", 1, 0.5), {}); });
}

TEST(LayOutMemory, GrowsWithTheVertices) { EXPECT_GT(layOutMemory(20000), layOutMemory(10000)); }

}  // namespace
}  // namespace innermap
