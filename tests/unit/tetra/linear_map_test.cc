#include <gtest/gtest.h>

#include "core/random.h"
#include "innermap/core/error.h"
#include "innermap/tetra/cells.h"
#include "tetra/kuhn_mesh.h"

namespace innermap {
namespace {

// Some vertices inside are elsewhere: no affine map.
CellMesh carriedCube() {
  CellMesh mesh = test::kuhnMesh(4);
  CellField source;
  source.name = "source";
  source.components = 3;
  const CounterRandom random(1, 1);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    Vec3& p = mesh.vertices[v];
    source.values.insert(source.values.end(), {p.x, p.y, p.z});
    p = {2 * p.x + 0.1 * random.uniform(v), p.y + 1, 3 * p.z};
  }
  mesh.vertexFields = {source};
  return mesh;
}

TEST(LinearCellMap, GoesThereAndBack) {
  const CellMesh mesh = carriedCube();
  const LinearCellMap map(mesh);
  const CounterRandom random(2, 2);
  for (std::uint64_t i = 0; i < 300; ++i) {
    const Vec3 p{random.uniform(3 * i), random.uniform(3 * i + 1), random.uniform(3 * i + 2)};
    const LinearSample there = map.push(p), back = map.pull(there.image);
    EXPECT_LT(norm(back.image - p), 1e-12);
    EXPECT_EQ(there.outside, 0);
    EXPECT_GT(determinant(there.jacobian), 0);
    EXPECT_NEAR(determinant(product(there.jacobian, back.jacobian)), 1, 1e-9);
  }
  // Vertices go exactly to vertices.
  const LinearSample corner = map.push({1, 1, 1});
  EXPECT_LT(norm(corner.image - mesh.vertices.back()), 1e-12);
  EXPECT_NEAR(map.push({0.5, 0.5, 1.2}).outside, 0.2, 1e-12);
}

TEST(LinearCellMap, RefusesWhatIsNoMap) {
  CellMesh bare = carriedCube();
  bare.vertexFields.clear();
  EXPECT_THROW(LinearCellMap{bare}, DataError);
  CellMesh folded = carriedCube();
  std::swap(folded.tetrahedra[0][0], folded.tetrahedra[0][1]);
  EXPECT_THROW(LinearCellMap{folded}, DataError);
  CellMesh cubes = test::cubeMesh(2);
  cubes.vertexFields = carriedCube().vertexFields;
  cubes.vertexFields[0].values.resize(3 * cubes.vertices.size());
  EXPECT_THROW(LinearCellMap{cubes}, DataError);
}

}  // namespace
}  // namespace innermap
