#include <gtest/gtest.h>

#include "core/random.h"
#include "innermap/core/error.h"
#include "innermap/tetra/remesh_cells.h"
#include "innermap/tetra/tetrahedralize.h"
#include "innermap/transfer/inverse_map.h"
#include "tetra/kuhn_mesh.h"
#include "tetra/mapped_balls.h"

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

TEST(LinearMap, GoesThereAndBack) {
  const CellMesh mesh = carriedCube();
  const SolidMap map = linearMapOf(mesh);
  const CounterRandom random(2, 2);
  Points points;
  for (std::uint64_t i = 0; i < 300; ++i)
    points.push_back({random.uniform(3 * i), random.uniform(3 * i + 1), random.uniform(3 * i + 2)});
  const auto there = map.push(points), back = map.pull(map.images(points, 0));
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LT(norm(back[i].image - points[i]), 1e-12);
    EXPECT_EQ(there[i].outside, 0);
    EXPECT_GT(determinant(there[i].jacobian), 0);
    EXPECT_NEAR(determinant(product(there[i].jacobian, back[i].jacobian)), 1, 1e-9);
  }
  // Vertices go exactly to vertices.
  const auto samples = map.push({{1, 1, 1}, {0.5, 0.5, 1.2}});
  EXPECT_LT(norm(samples[0].image - mesh.vertices.back()), 1e-12);
  EXPECT_NEAR(samples[1].outside, 0.2, 1e-12);
}

TEST(LinearMap, RefusesWhatIsNoMap) {
  CellMesh bare = carriedCube();
  bare.vertexFields.clear();
  EXPECT_THROW(linearMapOf(bare), DataError);
  CellMesh folded = carriedCube();
  std::swap(folded.tetrahedra[0][0], folded.tetrahedra[0][1]);
  EXPECT_THROW(linearMapOf(folded), DataError);
  CellMesh cubes = test::cubeMesh(2);
  cubes.vertexFields = carriedCube().vertexFields;
  cubes.vertexFields[0].values.resize(3 * cubes.vertices.size());
  EXPECT_THROW(linearMapOf(cubes), DataError);
}

CellMesh carriedBall(const MappedSolid& mapped) {
  return remeshCells(tetrahedralize(mapped.solid(), {.resolution = 10}), mapped).mesh;
}

TEST(LinearMap, CarriesPointsAsTheAffineMapThatItStandsFor) {
  const MappedSolid mapped = test::affineBall();
  const SolidMap map = linearMapOf(carriedBall(mapped), mapped);
  const Points inside{{0, 0, 0}, {0.3, 0.2, -0.4}, {-0.5, 0.1, 0.2}}, far{{3, 0, 0}};
  const PointCarry push = carryByMap(map, mapped, true), pull = carryByMap(map, mapped, false);
  const CarriedPoints there = push(inside, true), back = pull(there.points, false);
  ASSERT_EQ(there.jacobians.size(), inside.size());
  for (std::size_t i = 0; i < inside.size(); ++i) {
    EXPECT_LT(norm(there.points[i] - affineMap(inside[i])), 1e-9);
    EXPECT_LT(norm(back.points[i] - inside[i]), 1e-9);
    EXPECT_EQ(there.fates[i], PointFate::carried);
  }
  EXPECT_EQ(there.cut + there.outside, 0u);
  const CarriedPoints cut = push(far, false);
  EXPECT_EQ(cut.fates[0], PointFate::cut);
  EXPECT_EQ(cut.cut, 1u);
}

TEST(LinearMap, RefusesAMeshOfAnotherSolid) {
  const MappedSolid mapped = test::affineBall();
  CellMesh elsewhere = carriedBall(mapped);
  for (Vec3& p : elsewhere.vertices) p.x += 10;
  EXPECT_THROW(linearMapOf(elsewhere, mapped), DataError);
}

}  // namespace
}  // namespace innermap
