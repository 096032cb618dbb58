#include "innermap/correspond/mesh_correspondence.h"

#include <gtest/gtest.h>

#include "fit/blobs.h"

namespace innermap {
namespace {

using shapes::blob;

const Mesh kA = blob("a.obj", 1, 0.8), kB = blob("b.obj", 2, 0.5, {1.4, 0.9, 1});

TEST(CorrespondEstimates, GrowWithTheMeshes) {
  EXPECT_GT(correspondMemory(20000, 100), correspondMemory(1000, 100));
}

TEST(SameConnectivity, LooksAtPolygonsFirst) {
  Mesh a = kA, moved = kA;
  moved.vertices[3] = {5, 5, 5};
  EXPECT_TRUE(sameConnectivity(a, moved));
  EXPECT_FALSE(sameConnectivity(a, kB));
  std::swap(moved.triangles[0], moved.triangles[1]);
  EXPECT_FALSE(sameConnectivity(a, moved));
  // A square, cut both ways.
  Mesh one, other;
  one.vertices = other.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  one.triangles = {{0, 1, 2}, {0, 2, 3}};
  other.triangles = {{0, 1, 3}, {1, 2, 3}};
  EXPECT_FALSE(sameConnectivity(one, other));
  one.polygonStart = other.polygonStart = {0, 4};
  one.polygonCorners = other.polygonCorners = {0, 1, 2, 3};
  EXPECT_TRUE(sameConnectivity(one, other));
}

}  // namespace
}  // namespace innermap
