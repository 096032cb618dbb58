#include "innermap/mesh/seams.h"

#include <gtest/gtest.h>

#include "mesh/test_meshes.h"

namespace innermap {
namespace {

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
