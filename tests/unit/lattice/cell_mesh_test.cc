#include "innermap/lattice/cell_mesh.h"

#include <gtest/gtest.h>

#include <limits>

#include "innermap/core/error.h"

namespace innermap {
namespace {

CellMesh cube() {
  CellMesh mesh{
      .name = "cube",
      .vertices =
          {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
      .hexahedra = {{0, 1, 2, 3, 4, 5, 6, 7}}};
  return mesh;
}

CellMesh twoTetrahedra() {
  return {.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}},
          .tetrahedra = {{0, 1, 2, 3}, {1, 4, 2, 3}}};
}

TEST(CellMesh, SignedVolumeTellsInverted) {
  const CellMesh mesh = twoTetrahedra();
  EXPECT_NEAR(signedVolume(mesh.vertices, {0, 1, 2, 3}), 1.0 / 6, 1e-15);
  EXPECT_NEAR(signedVolume(mesh.vertices, {1, 0, 2, 3}), -1.0 / 6, 1e-15);
}

TEST(CellMesh, CornersOfACubeAreRightHanded) {
  const CellMesh mesh = cube();
  for (const Tetrahedron& t : cornerTetrahedra(mesh.hexahedra[0]))
    EXPECT_NEAR(signedVolume(mesh.vertices, t), 1.0 / 6, 1e-15);
}

TEST(CellMesh, BoundaryIsClosedAndOutward) {
  const CellMesh hex = cube(), tets = twoTetrahedra();
  EXPECT_EQ(boundaryTriangles(hex).size(), 12u);
  EXPECT_NEAR(signedVolume(hex.vertices, boundaryTriangles(hex)), 1, 1e-14);
  EXPECT_EQ(boundaryTriangles(tets).size(), 6u);
  double volume = 0;
  for (const Tetrahedron& t : tets.tetrahedra) volume += signedVolume(tets.vertices, t);
  EXPECT_NEAR(signedVolume(tets.vertices, boundaryTriangles(tets)), volume, 1e-14);
}

TEST(CellMesh, ValidateFindsWhatIsWrong) {
  CellMesh mesh = cube();
  mesh.cellFields = {{"stress", 6, CellField::Kind::scalar, std::vector<double>(6)}};
  EXPECT_NO_THROW(validate(mesh));
  CellMesh bad = mesh;
  bad.hexahedra[0][3] = 8;
  EXPECT_THROW(validate(bad), DataError);
  bad = mesh;
  bad.hexahedra[0][3] = 2;
  EXPECT_THROW(validate(bad), DataError);
  bad = mesh;
  bad.vertices[5].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(validate(bad), DataError);
  bad = mesh;
  bad.cellFields[0].values.pop_back();
  EXPECT_THROW(validate(bad), DataError);
  bad = mesh;
  bad.vertexFields = {{"velocity", 2, CellField::Kind::vector, std::vector<double>(16)}};
  EXPECT_THROW(validate(bad), DataError);
}

}  // namespace
}  // namespace innermap
