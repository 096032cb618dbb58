#include "innermap/mesh/mesh.h"

#include <gtest/gtest.h>

#include <functional>

#include "core/expect.h"
#include "core/pi.h"
#include "core/random.h"
#include "innermap/core/error.h"
#include "mesh/shapes.h"
#include "mesh/test_meshes.h"

namespace innermap {
namespace {

using shapes::icosphere;
using testing::cube;

TEST(Mesh, MeasuresOfTheUnitCube) {
  const Mesh mesh = cube(1, {3, -2, 5});
  EXPECT_NEAR(signedVolume(mesh), 1, 1e-14);
  EXPECT_NEAR(surfaceArea(mesh), 6, 1e-14);
  EXPECT_NEAR(signedVolume(shapes::flipped(mesh)), -1, 1e-14);
  EXPECT_NEAR(boundingBox(mesh).diagonal(), std::sqrt(3.0), 1e-14);
}

TEST(Mesh, VolumeIsPreciseFarFromTheOrigin) {
  // 1e6 diagonals away coordinates carry 1e-10 of the size; about the origin the volume would be
  // lost altogether (1e18 * 1e-16).
  const Mesh mesh = icosphere(3, 1, {1e6, -1e6, 1e6});
  EXPECT_NEAR(signedVolume(mesh) / signedVolume(icosphere(3)), 1, 1e-8);
}

TEST(Mesh, SphereVolumeConvergesAtSecondOrder) {
  double error[2];
  for (int k = 0; k < 2; ++k) error[k] = 4 * kPi / 3 - signedVolume(icosphere(3 + k));
  EXPECT_NEAR(error[0] / error[1], 4, 0.1);
}

TEST(Mesh, AreaVectorsOfAClosedMeshCancel) {
  const Mesh mesh = icosphere(2, 3, {1, 2, 3});
  Vec3 sum;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    sum += areaVector(mesh, static_cast<int>(t));
  EXPECT_NEAR(norm(sum), 0, 1e-12);
}

TEST(Mesh, BoundingBoxIgnoresLooseVertices) {
  Mesh mesh = cube();
  mesh.vertices.push_back({100, 100, 100});
  EXPECT_EQ(boundingBox(mesh).upper.x, 1);
}

TEST(Mesh, SurfacePointsFollowAnyPositions) {
  const Mesh mesh = cube();
  const CounterRandom random(7, 0);
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 100; ++i) {
    const double u = random.uniform(2 * i), v = (1 - u) * random.uniform(2 * i + 1);
    points.push_back({i % 12, {1 - u - v, u, v}});
  }
  Points moved = mesh.vertices;
  for (Vec3& p : moved) p = 2.0 * p + Vec3{1, 2, 3};
  const Points images = interpolate(moved, mesh.triangles, points);
  ASSERT_EQ(images.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_NEAR(norm(images[i] - (2.0 * positionOf(mesh, points[i]) + Vec3{1, 2, 3})), 0, 1e-14);
}

TEST(Mesh, ValidateAcceptsGoodMeshes) {
  EXPECT_NO_THROW(validate(cube()));
  Mesh loose = cube();
  loose.vertices.push_back({NAN, 0, 0});  // no triangle uses it
  EXPECT_NO_THROW(validate(loose));
}

TEST(Mesh, ValidateNamesWhatIsWrong) {
  const auto message = [](const std::function<void(Mesh&)>& spoil) {
    Mesh mesh = cube();
    mesh.name = "box.obj";
    spoil(mesh);
    return test::refusalOf<DataError>([&] { validate(mesh); });
  };
  EXPECT_EQ(message([](Mesh& m) { m.triangles[3][1] = 8; }),
            "box.obj: triangle 3 uses vertex 8 of 8 (counted from 0)");
  EXPECT_EQ(message([](Mesh& m) { m.triangles[3][1] = -1; }),
            "box.obj: triangle 3 uses vertex -1 of 8 (counted from 0)");
  EXPECT_EQ(message([](Mesh& m) { m.vertices[5].y = INFINITY; }),
            "box.obj: vertex 5 is not finite; remove or correct it");
  EXPECT_EQ(message([](Mesh& m) { m.colours.resize(3); }), "box.obj: has 3 colours for 8 vertices");
  EXPECT_NE(message([](Mesh& m) { m.uvTriangles.resize(2); }), "accepted");
  EXPECT_NE(message([](Mesh& m) { m.uvTriangles.resize(12, {0, 0, 0}); }), "accepted");
  EXPECT_NE(message([](Mesh& m) { m.polygonStart = {0, 3}; }), "accepted");
  EXPECT_NE(message([](Mesh& m) {
              m.polygonStart = {0, 3};
              m.polygonCorners = {0, 1, 9};
            }),
            "accepted");
}

TEST(Mesh, AreaAndVolumeOfPlainTrianglesAreThoseOfTheMesh) {
  const Mesh mesh = shapes::transformed(shapes::torus(20, 10), 3, {1, 2, 3});
  EXPECT_EQ(surfaceArea(mesh.vertices, mesh.triangles), surfaceArea(mesh));
  EXPECT_EQ(signedVolume(mesh.vertices, mesh.triangles), signedVolume(mesh));
  EXPECT_GT(surfaceArea(mesh), 0);
}

TEST(Mesh, LiesNearEnoughToTheOrigin) {
  Mesh mesh = shapes::icosphere(1);
  requireNearOrigin(mesh);
  for (Vec3& p : mesh.vertices) p = 1e-3 * p + Vec3{1e5, 0, 0};
  requireNearOrigin(mesh);
  for (Vec3& p : mesh.vertices) p = p + Vec3{0, 1e6, 0};
  EXPECT_THROW(requireNearOrigin(mesh), DataError);
  requireNearOrigin(Mesh());
}

}  // namespace
}  // namespace innermap
