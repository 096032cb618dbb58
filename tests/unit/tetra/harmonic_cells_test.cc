#include <gtest/gtest.h>

#include <cmath>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/tetra/compare_fem.h"
#include "innermap/tetra/tetrahedralize.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

CellMesh ball(int resolution) {
  return tetrahedralize(Solid(shapes::icosphere(3)), {.resolution = resolution});
}

// Of a function at all vertices; those inside must not be looked at.
template <class Function>
Matrix valuesOf(const CellMesh& mesh, const Function& f) {
  const std::vector<bool> on = boundaryVertices(mesh);
  Matrix m(mesh.vertices.size(), 2);
  for (std::size_t v = 0; v < on.size(); ++v) {
    m(v, 0) = on[v] ? f(mesh.vertices[v]) : 1e30;
    m(v, 1) = on[v] ? mesh.vertices[v].z : 1e30;
  }
  return m;
}

template <class Function>
double worst(const CellMesh& mesh, const HarmonicCells& solved, const Function& f) {
  double most = 0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    most = std::max(most, std::abs(solved.values(v, 0) - f(mesh.vertices[v])));
  return most;
}

TEST(HarmonicCells, LinearFunctionsAreExact) {
  const CellMesh mesh = ball(10);
  const auto f = [](const Vec3& p) { return 1 + 2 * p.x - p.y + 0.5 * p.z; };
  const HarmonicCells solved = harmonicOnCells(mesh, valuesOf(mesh, f));
  EXPECT_LT(worst(mesh, solved, f), 1e-7);
  EXPECT_GT(solved.unknowns, 0u);
  EXPECT_LE(solved.residual, 1e-9);
  EXPECT_GT(solved.iterations, 0);
}

TEST(HarmonicCells, QuadraticErrorsFallFourfoldWithHalfTheEdge) {
  const auto f = [](const Vec3& p) { return std::exp(2 * p.x) * std::sin(2 * p.y); };
  const CellMesh coarse = ball(10), fine = ball(20);
  const double a = worst(coarse, harmonicOnCells(coarse, valuesOf(coarse, f)), f);
  const double b = worst(fine, harmonicOnCells(fine, valuesOf(fine, f)), f);
  EXPECT_GT(a / b, 2.5);  // the largest error, not the mean one
}

TEST(HarmonicCells, GradientsOfTheCorners) {
  const Points p{{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const auto g = cornerGradients(p, {0, 1, 2, 3});
  EXPECT_NEAR(g[1].x, 0.5, 1e-15);
  EXPECT_NEAR(g[2].y, 1, 1e-15);
  EXPECT_NEAR(norm(g[0] + g[1] + g[2] + g[3]), 0, 1e-15);
}

TEST(HarmonicCells, ThreadsDoNotMatter) {
  const CellMesh mesh = ball(10);
  const auto f = [](const Vec3& p) { return p.x * p.x - p.y * p.y; };
  const HarmonicCells many = harmonicOnCells(mesh, valuesOf(mesh, f));
  const ThreadLimit one(1);
  const HarmonicCells few = harmonicOnCells(mesh, valuesOf(mesh, f));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    EXPECT_EQ(many.values(v, 0), few.values(v, 0));
}

TEST(HarmonicCells, RefusesWhatIsNoMeshOfTetrahedra) {
  CellMesh mesh = ball(8);
  const auto f = [](const Vec3& p) { return p.x; };
  EXPECT_THROW(harmonicOnCells(mesh, Matrix(3, 1)), DataError);
  EXPECT_THROW(harmonicOnCells({}, Matrix()), DataError);
  EXPECT_THROW(harmonicOnCells(mesh, valuesOf(mesh, f), {.maxIterations = 1}), DataError);
  EXPECT_THROW(harmonicOnCells(mesh, valuesOf(mesh, f), {.residual = 2, .maxIterations = 1}),
               SettingError);
  test::expectCancels([&] { harmonicOnCells(mesh, valuesOf(mesh, f), {}); });
  std::swap(mesh.tetrahedra[5][0], mesh.tetrahedra[5][1]);
  EXPECT_THROW(harmonicOnCells(mesh, valuesOf(mesh, f)), DataError);
}

}  // namespace
}  // namespace innermap
