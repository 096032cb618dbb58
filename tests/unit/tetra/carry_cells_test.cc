#include <gtest/gtest.h>

#include <algorithm>

#include "innermap/core/error.h"
#include "innermap/tetra/cells.h"
#include "innermap/tetra/tetrahedralize.h"
#include "tetra/kuhn_mesh.h"
#include "tetra/mapped_balls.h"

namespace innermap {
namespace {

using test::affineBall;

CellMesh filled(const MappedSolid& mapped, int resolution = 10) {
  return tetrahedralize(mapped.solid(), {.resolution = resolution});
}

TEST(CarryCells, InsideByTheMapBoundaryByItsPlaces) {
  const MappedSolid mapped = affineBall();
  const CellMesh mesh = filled(mapped);
  const CellCarry carry = carryCells(mesh, mapped);
  const Mesh target = targetSurface(mapped);
  std::size_t boundary = 0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const SurfacePoint& place = carry.cells.onSurface[v];
    boundary += place.triangle >= 0;
    if (place.triangle >= 0)
      EXPECT_LT(norm(carry.cells.positions[v] - positionOf(target, place)), 1e-12);
    else
      EXPECT_LT(norm(carry.cells.positions[v] - affineMap(mesh.vertices[v])), 1e-9);
  }
  EXPECT_EQ(boundary, carry.boundaryVertices);
  EXPECT_GT(boundary, 100u);
  EXPECT_LT(boundary, mesh.vertices.size());
  EXPECT_LT(carry.boundaryMax, 0.02);
}

TEST(CarryCells, BackByATetrahedralMap) {
  const MappedSolid mapped = affineBall();
  const CellMesh lattice = filled(mapped, 6);
  Points carried;
  for (const Vec3& p : lattice.vertices) carried.push_back(affineMap(p));
  CellMesh mesh = filled(mapped, 12);
  const Points given = mesh.vertices;
  for (Vec3& p : mesh.vertices) p = affineMap(p);
  const CellCarry back = carryCellsBack(mesh, mapped, {&lattice, &carried});
  // Just within the surface the coarse lattice ends earlier than the solid.
  std::vector<double> off;
  for (std::size_t v = 0; v < given.size(); ++v)
    off.push_back(norm(back.cells.positions[v] - given[v]));
  EXPECT_LT(*std::max_element(off.begin(), off.end()), 0.1);
  std::nth_element(off.begin(), off.begin() + off.size() / 2, off.end());
  EXPECT_LT(off[off.size() / 2], 1e-9);
}

// A face of one cube bulges over the middle of the gap to the other one.
TEST(CarryCells, NarrowGapsDoNotCatchTheBoundary) {
  const Mesh one = test::surfaceOf(test::kuhnMesh(4));
  Mesh both = one;
  for (const Vec3& p : one.vertices) both.vertices.push_back(p + Vec3{1.02, 0, 0});
  const int count = static_cast<int>(one.vertices.size());
  for (const Triangle& t : one.triangles)
    both.triangles.push_back({t[0] + count, t[1] + count, t[2] + count});
  Mesh target = both;
  for (std::size_t v = one.vertices.size(); v < both.vertices.size(); ++v)
    target.vertices[v].x += 5;
  MappedSolid mapped = affineBall();
  mapped.boundary = makeBoundaryPair(both, target);
  CellMesh mesh = test::kuhnMesh(4);
  std::size_t bulging = 0;
  for (Vec3& p : mesh.vertices)
    if (p.x > 0.99 && std::min({p.y, p.z, 1 - p.y, 1 - p.z}) > 0.01) {
      p.x = 1.015;
      ++bulging;
    }
  const CellCarry carry = carryCells(mesh, mapped);
  EXPECT_EQ(carry.readdressed, bulging);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (carry.cells.onSurface[v].triangle >= 0) {
      EXPECT_LT(carry.cells.positions[v].x, 1.001);
    }
}

TEST(CarryCells, SaysWhatDoesNotFit) {
  const MappedSolid mapped = affineBall();
  CellMesh mesh = filled(mapped);
  EXPECT_THROW(carryCells(CellMesh(), mapped), DataError);
  EXPECT_THROW(carryCells(mesh, mapped, {.farthest = 0}), SettingError);
  for (Vec3& p : mesh.vertices) p.x += 1;
  EXPECT_THROW(carryCells(mesh, mapped), DataError);
}

}  // namespace
}  // namespace innermap
