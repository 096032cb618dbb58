#include "innermap/tetra/remesh_cells.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/tetra/cells.h"
#include "innermap/tetra/tetrahedralize.h"
#include "tetra/kuhn_mesh.h"
#include "tetra/mapped_balls.h"

namespace innermap {
namespace {

CellMesh filled(const Solid& solid, int resolution) {
  TetrahedralizeSettings settings;
  settings.resolution = resolution;
  return tetrahedralize(solid, settings);
}

const MappedSolid& dented() {
  static const MappedSolid mapped = test::dentedBall();
  return mapped;
}

const CellField* fieldOf(const CellMesh& mesh, const std::string& name) {
  for (const CellField& f : mesh.vertexFields)
    if (f.name == name) return &f;
  return nullptr;
}

TEST(RemeshCellsRelease, ADentedBallIsTurnedRight) {
  const CellMesh mesh = filled(dented().solid(), 24);
  const Remesh made = remeshCells(mesh, dented());
  EXPECT_GT(made.invertedCarried, 0u);
  EXPECT_EQ(made.inverted, 0u);
  EXPECT_EQ(made.repair.notLanded, 0u);
  EXPECT_LT(made.boundaryMax, 1e-8);
  EXPECT_GT(made.quality.dihedral.least, 1);
  EXPECT_GT(made.quality.dihedral.onePercent, 8);
  ASSERT_NE(fieldOf(made.mesh, "source"), nullptr);
  // Nothing of the source is lost or inverted: the two are a map.
  const LinearCellMap map(made.mesh);
  EXPECT_LT(norm(map.pull(map.push({0.2, 0.1, -0.4}).image).image - Vec3{0.2, 0.1, -0.4}), 1e-9);
}

TEST(RemeshCellsRelease, KeepsTheConnectivityWhereAsked) {
  const CellMesh mesh = filled(dented().solid(), 16);
  RemeshSettings settings;
  settings.keepConnectivity = true;
  const Remesh made = remeshCells(mesh, dented(), settings);
  EXPECT_EQ(made.inverted, 0u);
  EXPECT_EQ(made.mesh.tetrahedra, mesh.tetrahedra);
  EXPECT_EQ(made.mesh.vertices.size(), mesh.vertices.size());
}

TEST(RemeshCells, AffineMapsNeedNoRepairAndTurnFields) {
  const MappedSolid mapped = test::affineBall();
  CellMesh mesh = filled(mapped.solid(), 8);
  CellField fibre, normal, label;
  fibre.name = "fibre";
  normal.name = "normal";
  fibre.components = normal.components = 3;
  fibre.kind = CellField::Kind::vector;
  normal.kind = CellField::Kind::normal;
  label.name = "label";
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    fibre.values.insert(fibre.values.end(), {1, 0, 0});
    label.values.push_back(static_cast<double>(t));
  }
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    normal.values.insert(normal.values.end(), {0, 1, 0});
  mesh.cellFields = {fibre, label};
  mesh.vertexFields = {normal};
  RemeshSettings settings;
  settings.keepConnectivity = true;
  const Remesh made = remeshCells(mesh, mapped, settings);
  EXPECT_EQ(made.invertedCarried, 0u);
  EXPECT_EQ(made.repair.slid, 0u);
  EXPECT_EQ(made.mesh.cellFields[1].values, label.values);
  const Vec3 x = affineMap({1, 0, 0}) - affineMap({0, 0, 0});
  const Vec3 z = affineMap({0, 0, 1}) - affineMap({0, 0, 0});
  // Cells inside are carried by the affine map alone.
  std::vector<char> border(mesh.vertices.size(), 0);
  for (const Triangle& t : boundaryTriangles(mesh))
    for (const int v : t) border[v] = 1;
  std::size_t checked = 0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const Tetrahedron& c = mesh.tetrahedra[t];
    if (std::any_of(c.begin(), c.end(), [&](int v) { return border[v] != 0; })) continue;
    const double* f = &made.mesh.cellFields[0].values[3 * t];
    EXPECT_LT(norm(Vec3{f[0], f[1], f[2]} - x), 1e-8);
    ++checked;
  }
  EXPECT_GT(checked, 20u);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    bool inside = true;
    for (const Tetrahedron& c : mesh.tetrahedra)
      if (std::find(c.begin(), c.end(), static_cast<int>(v)) != c.end())
        for (const int w : c) inside = inside && !border[w];
    if (!inside) continue;
    const double* n = &made.mesh.vertexFields[0].values[3 * v];
    EXPECT_NEAR(dot({n[0], n[1], n[2]}, x), 0, 1e-8);
    EXPECT_NEAR(dot({n[0], n[1], n[2]}, z), 0, 1e-8);
    EXPECT_NEAR(norm({n[0], n[1], n[2]}), 1, 1e-12);
  }
}

TEST(RemeshCellsRelease, BringsATargetsMeshBack) {
  const CellMesh mesh = filled(makeTargetSolid(dented().boundary), 20);
  RemeshSettings settings;
  settings.back = true;
  settings.coarse = 20;
  const Remesh made = remeshCells(mesh, dented(), settings);
  EXPECT_EQ(made.inverted, 0u);
  EXPECT_LT(made.boundaryMax, 1e-8);
  EXPECT_GT(made.quality.dihedral.least, 1);
}

TEST(RemeshCellsRelease, SameForAnyNumberOfThreads) {
  const CellMesh mesh = filled(dented().solid(), 14);
  Points first;
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    const Remesh made = remeshCells(mesh, dented());
    if (first.empty()) first = made.mesh.vertices;
    ASSERT_EQ(first.size(), made.mesh.vertices.size());
    for (std::size_t v = 0; v < first.size(); ++v)
      ASSERT_EQ(0, norm(first[v] - made.mesh.vertices[v]));
  }
}

TEST(RemeshCells, InvertedInputIsCounted) {
  const MappedSolid mapped = test::affineBall();
  CellMesh mesh = filled(mapped.solid(), 8);
  std::swap(mesh.tetrahedra[7][0], mesh.tetrahedra[7][1]);
  const Remesh made = remeshCells(mesh, mapped);
  EXPECT_EQ(made.invertedAtRest, 1u);
  EXPECT_LE(made.inverted, 1u);
  EXPECT_FALSE(made.notes.empty());
}

TEST(RemeshCells, RefusesSettingsAndIsCancelled) {
  const MappedSolid mapped = test::affineBall();
  const CellMesh mesh = filled(mapped.solid(), 6);
  RemeshSettings settings;
  settings.coarse = 3;
  EXPECT_THROW(remeshCells(mesh, mapped, settings), SettingError);
  settings = {};
  RunContext run;
  run.cancel();
  const RunScope scope(run);
  EXPECT_THROW(remeshCells(mesh, mapped, settings), Cancelled);
}

}  // namespace
}  // namespace innermap
