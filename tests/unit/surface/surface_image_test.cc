#include <gtest/gtest.h>

#include "core/expect.h"
#include "innermap/surface/correspond.h"
#include "mesh/test_meshes.h"
#include "surface/detail/refining/locate.h"

namespace innermap {
namespace {

// A ball with a hollow, onto another such of five times the size: the same directions.
struct Balls {
  SurfaceShells a = closedSurfaces(
      shapes::joined(shapes::icosphere(3), shapes::flipped(shapes::icosphere(2, 0.5))));
  SurfaceShells b = closedSurfaces(
      shapes::joined(shapes::flipped(shapes::icosphere(3, 2)), shapes::icosphere(2, 5)));
  Correspondence map;

  Balls() {
    for (int s = 0; s < 2; ++s) {
      ShellCorrespondence shell{.source = s,
                                .target = 1 - s,
                                .surface = a.shells[static_cast<std::size_t>(s)],
                                .targetSurface = b.shells[static_cast<std::size_t>(1 - s)]};
      shell.image.place = directions(shell.surface.vertices);
      shell.targetLayout.place = directions(shell.targetSurface.vertices);
      // A cavity's layout is that of the surface turned over, seen in a mirror.
      if (s == 1)
        for (Points* places : {&shell.image.place, &shell.targetLayout.place})
          for (Vec3& p : *places) p.x = -p.x;
      map.shells.push_back(shell);
    }
  }
  static Points directions(const Points& points) {
    Points result;
    for (const Vec3& p : points) result.push_back(p / norm(p));
    return result;
  }
};

TEST(ImagesOf, PointsGoWhereTheClosestPointGoes) {
  const Balls balls;
  const CounterRandom random(5, 0);
  Points points;
  for (std::uint64_t i = 0; i < 500; ++i) points.push_back(shapes::randomPoint(random, i));
  const SurfaceImages images = imagesOf(points, balls.map, balls.b);
  ASSERT_EQ(images.positions.size(), points.size());
  double farthest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double r = norm(points[i]);
    farthest = std::max(farthest, std::min(std::abs(r - 1), std::abs(r - 0.5)));
    if (std::abs(r - 0.75) < 0.03) continue;  // either shell may be the closer one
    const Vec3& p = images.positions[i];
    EXPECT_NEAR(norm(p), r > 0.75 ? 5 : 2, 0.15);
    EXPECT_GT(dot(p, points[i]) / (norm(p) * r), 0.995);
    // The address is of the mesh as a whole.
    EXPECT_LT(norm(positionOf(balls.b.mesh, images.onTarget[i]) - p), 1e-12);
  }
  EXPECT_NEAR(images.farthest, farthest, 0.05);
}

TEST(PreimagesOf, LeadBack) {
  const Balls balls;
  Points points;
  for (int t = 0; t < static_cast<int>(balls.a.mesh.triangles.size()); t += 7)
    points.push_back(positionOf(balls.a.mesh, {t, {0.2, 0.5, 0.3}}));
  const SurfaceImages images = imagesOf(points, balls.map, balls.b);
  const Points back = preimagesOf(images.onTarget, balls.map, balls.b);
  ASSERT_EQ(back.size(), points.size());
  for (std::size_t i = 0; i < back.size(); ++i) EXPECT_LT(norm(back[i] - points[i]), 1e-9);
}

TEST(PreimagesOf, OfTrianglesThatAreInNoShellComeFromTheClosestOne) {
  Balls balls;
  const Triangle last = balls.b.mesh.triangles.back();
  balls.b.mesh.triangles.push_back(last);  // a duplicate
  const int number = static_cast<int>(balls.b.mesh.triangles.size()) - 1;
  const Points back =
      preimagesOf({{number, {0.3, 0.3, 0.4}}, {number - 1, {0.3, 0.3, 0.4}}}, balls.map, balls.b);
  EXPECT_LT(norm(back[0] - back[1]), 1e-9);
}

TEST(ImagesOf, CanBeCancelled) {
  const Balls balls;
  test::expectCancels([&] { preimagesOf({{0, {1, 0, 0}}}, balls.map, balls.b); });
  test::expectCancels([&] { imagesOf({{1, 0, 0}}, balls.map, balls.b); });
}

}  // namespace
}  // namespace innermap
