#include <gtest/gtest.h>

#include <algorithm>

#include "core/random.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/tetra/remesh_cells.h"
#include "mesh/triangle_tree.h"
#include "tetra/kuhn_mesh.h"

namespace innermap {
namespace {

using test::cubeMesh;
using test::kuhnMesh;
using test::surfaceOf;

// At rest, every vertex of the boundary on its own place.
CarriedCells atRest(const CellMesh& mesh, const Mesh& surface) {
  CarriedCells out{mesh.vertices, {}};
  const TriangleTree tree(surface.vertices, surface.triangles);
  std::vector<char> border(mesh.vertices.size(), 0);
  for (const Triangle& t : boundaryTriangles(mesh))
    for (const int v : t) border[v] = 1;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    out.onSurface.push_back(border[v] ? tree.closest(mesh.vertices[v]).address
                                      : SurfacePoint{-1, {1, 0, 0}});
  return out;
}

void shake(CarriedCells& cells, double size, std::uint64_t seed) {
  const CounterRandom random(seed, 3);
  for (std::size_t v = 0; v < cells.positions.size(); ++v)
    if (cells.onSurface[v].triangle < 0)
      for (int k = 0; k < 3; ++k)
        cells.positions[v][k] += size * (random.uniform(3 * v + static_cast<std::size_t>(k)) - 0.5);
}

std::size_t inverted(const CellMesh& mesh, const Points& at) {
  std::size_t count = 0;
  for (const Tetrahedron& t : mesh.tetrahedra) count += !(signedVolume(at, t) > 0);
  for (const Hexahedron& h : mesh.hexahedra)
    for (const Tetrahedron& t : cornerTetrahedra(h)) count += !(signedVolume(at, t) > 0);
  return count;
}

TEST(RepairCells, WhatIsNotInvertedStaysUntouched) {
  const CellMesh mesh = kuhnMesh(4);
  Mesh surface = surfaceOf(mesh);
  CarriedCells cells = atRest(mesh, surface);
  const Mat3 linear{{{2, 0.5, 0}, {0, 1, -0.3}, {0.2, 0, 3}}};
  for (Vec3& p : surface.vertices) p = linear * p;
  for (Vec3& p : cells.positions) p = linear * p;
  const Points before = cells.positions;
  const CellRepair repair = repairCells(mesh, surface, cells);
  EXPECT_EQ(repair.invertedAfter, 0u);
  EXPECT_EQ(repair.slid, 0u);
  EXPECT_LT(repair.farthestMoved, 1e-15);
  for (std::size_t v = 0; v < before.size(); ++v)
    EXPECT_LT(norm(before[v] - cells.positions[v]), 1e-15);
}

TEST(RepairCells, AShakenLatticeIsTurnedRightWithinItsBoundary) {
  for (const CellMesh& mesh : {kuhnMesh(6), cubeMesh(6)}) {
    SCOPED_TRACE(mesh.name);
    const Mesh surface = surfaceOf(mesh);
    CarriedCells cells = atRest(mesh, surface);
    shake(cells, 0.5, 5);
    const std::size_t before = inverted(mesh, cells.positions);
    ASSERT_GT(before, 100u);
    const CellRepair repair = repairCells(mesh, surface, cells);
    EXPECT_EQ(repair.invertedAfter, 0u);
    EXPECT_EQ(repair.poorAfter, 0u);
    EXPECT_EQ(inverted(mesh, cells.positions), 0u);
    EXPECT_EQ(repair.slid, 0u);
    EXPECT_GT(repair.farthestMoved, 0.1);
  }
}

// A vertex of the boundary is carried past its neighbours: no position of what is inside helps.
TEST(RepairCells, ABoundaryThatFoldsSlides) {
  constexpr int kSide = 6;
  for (const CellMesh& mesh : {kuhnMesh(kSide), cubeMesh(kSide)}) {
    SCOPED_TRACE(mesh.name);
    const Mesh surface = surfaceOf(mesh);
    CarriedCells cells = atRest(mesh, surface);
    const TriangleTree tree(surface.vertices, surface.triangles);
    std::size_t moved = 0;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      if (norm(mesh.vertices[v] - Vec3{0.5, 0.5, 0}) < 1e-9) {
        cells.positions[v] = mesh.vertices[v] + Vec3{0.22, 0.02, 0};
        cells.onSurface[v] = tree.closest(cells.positions[v]).address;
        ++moved;
      }
    ASSERT_EQ(moved, 1u);
    const CellRepair repair = repairCells(mesh, surface, cells);
    EXPECT_EQ(repair.invertedAfter, 0u);
    EXPECT_GT(repair.slid, 0u);
    EXPECT_EQ(repair.notLanded, 0u);
    for (const Triangle& t : surface.triangles)
      for (const int v : t) EXPECT_LT(tree.closest(cells.positions[v]).distance, 1e-8);
  }
}

TEST(RepairCells, AnchorsHoldTheBoundary) {
  const CellMesh mesh = cubeMesh(5);
  const Mesh surface = surfaceOf(mesh);
  double ways[2];
  for (int k = 0; k < 2; ++k) {
    CarriedCells cells = atRest(mesh, surface);
    shake(cells, 0.5, 5);
    // A stretched boundary would rather spread evenly.
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      const double x = cells.positions[v].x;
      if (cells.onSurface[v].triangle >= 0) cells.positions[v].x = 0.5 * x + 0.5 * x * x;
    }
    const CellRepair repair =
        repairCells(mesh, surface, cells, {.whole = true, .anchor = k == 0 ? 0.0 : 20.0});
    EXPECT_EQ(repair.invertedAfter, 0u);
    ways[k] = 0;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      if (cells.onSurface[v].triangle >= 0) {
        const double x = mesh.vertices[v].x;
        ways[k] = std::max(ways[k], std::abs(cells.positions[v].x - (0.5 * x + 0.5 * x * x)));
      }
  }
  EXPECT_GT(ways[0], 0.05);
  EXPECT_LT(ways[1], 0.5 * ways[0]);
}

TEST(RepairCells, SaysWhatIsWrongAndIsCancelled) {
  const CellMesh mesh = kuhnMesh(3);
  const Mesh surface = surfaceOf(mesh);
  CarriedCells cells = atRest(mesh, surface);
  CarriedCells fewer = cells;
  fewer.positions.pop_back();
  EXPECT_THROW(repairCells(mesh, surface, fewer), DataError);
  CarriedCells lost = cells;
  lost.onSurface[0].triangle = 999999;
  EXPECT_THROW(repairCells(mesh, surface, lost), DataError);
  EXPECT_THROW(repairCells(mesh, surface, cells, {.least = 0}), SettingError);
  RunContext run;
  run.cancel();
  const RunScope scope(run);
  shake(cells, 0.5, 1);
  EXPECT_THROW(repairCells(mesh, surface, cells, {}), Cancelled);
}

}  // namespace
}  // namespace innermap
