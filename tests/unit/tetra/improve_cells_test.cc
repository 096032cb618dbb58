#include <gtest/gtest.h>

#include "core/expect.h"
#include "core/random.h"
#include "innermap/core/error.h"
#include "innermap/tetra/cells.h"
#include "innermap/tetra/remesh_cells.h"
#include "mesh/triangle_tree.h"
#include "tetra/kuhn_mesh.h"

namespace innermap {
namespace {

struct Case {
  CellMesh mesh = test::kuhnMesh(6);
  Mesh surface = test::surfaceOf(mesh);
  CarriedCells cells{mesh.vertices, {}};

  // Vertices inside are shaken, but no tetrahedron is turned; in x all is stretched.
  Case() {
    const TriangleTree tree(surface.vertices, surface.triangles);
    std::vector<char> border(mesh.vertices.size(), 0);
    for (const Triangle& t : surface.triangles)
      for (const int v : t) border[v] = 1;
    const CounterRandom random(7, 7);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      cells.onSurface.push_back(border[v] ? tree.closest(mesh.vertices[v]).address
                                          : SurfacePoint{-1, {1, 0, 0}});
      if (border[v]) continue;
      const Vec3 way{random.uniform(3 * v) - 0.5, random.uniform(3 * v + 1) - 0.5,
                     random.uniform(3 * v + 2) - 0.5};
      for (double share = 0.3; share > 0.01; share /= 2) {
        const Vec3 here = cells.positions[v];
        cells.positions[v] = here + share * way;
        if (inverted() == 0) break;
        cells.positions[v] = here;
      }
    }
    for (Vec3& p : cells.positions) p.x *= 3;
    for (Vec3& p : surface.vertices) p.x *= 3;
  }

  std::size_t inverted() const {
    std::size_t count = 0;
    for (const Tetrahedron& t : mesh.tetrahedra)
      count += !(signedVolume(cells.positions, t) > 0) + !(signedVolume(mesh.vertices, t) > 0);
    return count;
  }

  CellQuality quality() const {
    CellMesh carried = mesh;
    carried.vertices = cells.positions;
    return cellQuality(carried);
  }
};

TEST(ImproveCells, RaisesAnglesAndKeepsTheMeshAMap) {
  for (const bool connect : {true, false}) {
    SCOPED_TRACE(connect ? "connectivity changes" : "vertices alone");
    Case c;
    ASSERT_EQ(c.inverted(), 0u);
    const CellQuality before = c.quality();
    const std::size_t count = c.mesh.tetrahedra.size();
    const CellImprovement done = improveCells(c.mesh, c.surface, c.cells, {.connect = connect});
    const CellQuality after = c.quality();
    EXPECT_GT(done.poorBefore, 100u);
    EXPECT_LT(done.poorAfter, done.poorBefore / (connect ? 4 : 1));
    EXPECT_GT(after.dihedral.least, before.dihedral.least);
    EXPECT_GT(after.dihedral.onePercent, before.dihedral.onePercent);
    EXPECT_EQ(c.inverted(), 0u);
    ASSERT_EQ(done.origin.size(), c.mesh.tetrahedra.size());
    if (!connect) {
      EXPECT_EQ(c.mesh.tetrahedra.size(), count);
      EXPECT_EQ(done.swaps + done.collapses, 0u);
      for (std::size_t t = 0; t < count; ++t) EXPECT_EQ(done.origin[t], static_cast<int>(t));
    }
    double here = 0, there = 0;
    for (const Tetrahedron& t : c.mesh.tetrahedra) {
      here += signedVolume(c.cells.positions, t);
      there += signedVolume(c.mesh.vertices, t);
    }
    EXPECT_NEAR(here, 3, 0.02);  // edges are left where angles are small
    EXPECT_NEAR(there, 1, 1e-9);
    // What was the boundary is the boundary still.
    EXPECT_EQ(boundaryTriangles(c.mesh).size(), c.surface.triangles.size());
    const TriangleTree tree(c.surface.vertices, c.surface.triangles);
    for (const Triangle& t : boundaryTriangles(c.mesh))
      for (const int v : t) EXPECT_LT(tree.closest(c.cells.positions[v]).distance, 1e-9);
  }
}

TEST(ImproveCells, GoodOnesStay) {
  Case c;
  c.cells.positions = c.mesh.vertices;
  const Mesh surface = test::surfaceOf(c.mesh);
  const CellImprovement done = improveCells(c.mesh, surface, c.cells);
  EXPECT_EQ(done.poorBefore, 0u);
  EXPECT_EQ(done.origin.size(), c.mesh.tetrahedra.size());
}

TEST(ImproveCells, SaysWhatIsWrongAndIsCancelled) {
  Case c;
  EXPECT_THROW(improveCells(c.mesh, c.surface, c.cells, {.angle = 0}), SettingError);
  EXPECT_THROW(improveCells(c.mesh, c.surface, c.cells, {.passes = 0}), SettingError);
  test::expectCancels([&] { improveCells(c.mesh, c.surface, c.cells, {}); });
  c.cells.onSurface.pop_back();
  EXPECT_THROW(improveCells(c.mesh, c.surface, c.cells), DataError);
}

}  // namespace
}  // namespace innermap
