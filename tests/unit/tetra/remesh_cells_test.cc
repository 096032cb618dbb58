#include "innermap/tetra/remesh_cells.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "innermap/tetra/tetrahedralize.h"
#include "tetra/kuhn_mesh.h"
#include "tetra/mapped_balls.h"

namespace innermap {
namespace {

CellMesh filled(const Solid& solid, int resolution) {
  return tetrahedralize(solid, {.resolution = resolution});
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
  const Remesh made = remeshCells(mesh, mapped, {.keepConnectivity = true});
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

TEST(RemeshCells, InvertedInputIsCounted) {
  const MappedSolid mapped = test::affineBall();
  CellMesh mesh = filled(mapped.solid(), 8);
  std::swap(mesh.tetrahedra[7][0], mesh.tetrahedra[7][1]);
  const Remesh made = remeshCells(mesh, mapped);
  EXPECT_EQ(made.invertedAtRest, 1u);
  EXPECT_LE(made.inverted, 1u);
  EXPECT_FALSE(made.notes.empty());
}

}  // namespace
}  // namespace innermap
