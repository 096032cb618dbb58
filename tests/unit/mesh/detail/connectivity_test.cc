#include "mesh/connectivity.h"

#include <gtest/gtest.h>

#include "mesh/test_meshes.h"

namespace innermap {
namespace {

TEST(SortedEdges, OfAClosedMeshAreInPairsThatRunBothWays) {
  const Mesh mesh = shapes::torus(12, 8);
  const std::vector<EdgeUse> edges = sortedEdges(mesh.triangles);
  ASSERT_EQ(edges.size(), 3 * mesh.triangles.size());
  std::size_t count = 0;
  forEachEdge(edges, [&](const EdgeUse* begin, const EdgeUse* end) {
    ++count;
    ASSERT_EQ(end - begin, 2);
    EXPECT_NE(begin[0].forward, begin[1].forward);
    for (const EdgeUse* use = begin; use != end; ++use) {
      const Triangle& t = mesh.triangles[static_cast<std::size_t>(use->side() / 3)];
      EXPECT_EQ(t[use->side() % 3], use->forward ? use->low : use->high);
      EXPECT_EQ(t[(use->side() + 1) % 3], use->forward ? use->high : use->low);
      EXPECT_LT(use->low, use->high);
    }
  });
  EXPECT_EQ(2 * count, edges.size());
}

TEST(SortedEdges, TellBoundariesAndFansApart) {
  // Three triangles at the edge 0-1; one that repeats a vertex and has no edges.
  const std::vector<EdgeUse> edges = sortedEdges({{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {2, 2, 3}});
  ASSERT_EQ(edges.size(), 9u);
  std::vector<std::ptrdiff_t> uses;
  forEachEdge(edges,
              [&](const EdgeUse* begin, const EdgeUse* end) { uses.push_back(end - begin); });
  EXPECT_EQ(uses, (std::vector<std::ptrdiff_t>{3, 1, 1, 1, 1, 1, 1}));
  for (int t = 0; t < 3; ++t) EXPECT_EQ(edges[static_cast<std::size_t>(t)].triangle, t);
  EXPECT_TRUE(sortedEdges({}).empty());
}

TEST(JoinedVertices, AreThemselvesInAClosedMesh) {
  const Mesh mesh = shapes::torus(12, 8);
  const std::vector<int> joined = joinedVertices(mesh.vertices, mesh.triangles);
  for (std::size_t v = 0; v < joined.size(); ++v) EXPECT_EQ(joined[v], static_cast<int>(v));
}

TEST(JoinedVertices, CloseAMeshWhoseTrianglesHaveVerticesOfTheirOwn) {
  const Mesh mesh = testing::exploded(shapes::icosphere(2));
  const std::vector<int> joined = joinedVertices(mesh.vertices, mesh.triangles);
  ASSERT_EQ(joined.size(), mesh.vertices.size());
  for (std::size_t v = 0; v < joined.size(); ++v) {
    EXPECT_LE(joined[v], static_cast<int>(v));
    EXPECT_EQ(joined[joined[v]], joined[v]);
    EXPECT_EQ(norm(mesh.vertices[joined[v]] - mesh.vertices[v]), 0);
  }
  std::size_t closed = 0;
  EXPECT_EQ(joinedVertices(mesh.vertices, mesh.triangles, &closed), joined);
  EXPECT_EQ(2 * closed, mesh.vertices.size());
  std::vector<int> distinct = joined;
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  EXPECT_EQ(distinct.size(), shapes::icosphere(2).vertices.size());
}

TEST(JoinedVertices, OfPartsThatTouchInACornerStayApart) {
  const Mesh mesh = shapes::joined(testing::cube(), testing::cube(1, {1, 1, 1}));
  const std::vector<int> joined = joinedVertices(mesh.vertices, mesh.triangles);
  for (std::size_t v = 0; v < joined.size(); ++v) EXPECT_EQ(joined[v], static_cast<int>(v));
}

}  // namespace
}  // namespace innermap
