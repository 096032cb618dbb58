#include "sample/source_points.h"

#include <gtest/gtest.h>

#include "core/expect.h"
#include "innermap/core/run.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

SourceSettings sources(std::size_t count, std::uint64_t seed = 1) {
  return {.count = count, .seed = seed};
}

TEST(SourceShellRelease, StandsAtTheDistanceOutside) {
  const Mesh overlapping =
      shapes::joined(shapes::torus(60, 30), shapes::icosphere(3, 0.5, {1, 0.1, 0.2}));
  for (const Mesh& mesh : {shapes::torus(60, 30), shapes::box({0, 0, 0}, {1, 2, 3}), overlapping}) {
    const Solid solid(mesh);
    for (const double d : {2e-4, 0.02, 0.4}) {
      SCOPED_TRACE(::testing::Message() << mesh.name << " at " << d);
      const Points points = sourceShell(solid, d, sources(700));
      ASSERT_EQ(points.size(), 700u);
      for (const Vec3& p : points) {
        EXPECT_FALSE(solid.inside(p));
        const double share = solid.distance(p) / (d * solid.diagonal());
        EXPECT_GE(share, 0.969);
        EXPECT_LE(share, 1.051);
      }
    }
  }
}

TEST(SourceShell, IsBlueNoise) {
  const Solid solid(shapes::icosphere(4));
  const std::size_t n = 1500;
  const Points points = sourceShell(solid, 0.05, sources(n));
  const double r = 1 + 0.05 * solid.diagonal();
  const double largest = 2 * std::sqrt(4 * kPi * r * r / (2 * std::sqrt(3.0) * n));
  EXPECT_GT(shapes::leastDistance(points), 0.58 * largest);
}

TEST(SourceShell, SameForAnyNumberOfThreadsAndForScaleAndPlace) {
  const Mesh mesh = shapes::torus(60, 30);
  const Solid solid(mesh);
  Points one, four;
  {
    const ThreadLimit limit(1);
    one = sourceShell(solid, 0.03, sources(500));
  }
  {
    const ThreadLimit limit(4);
    four = sourceShell(solid, 0.03, sources(500));
  }
  for (std::size_t i = 0; i < one.size(); ++i) ASSERT_EQ(norm(one[i] - four[i]), 0);
  EXPECT_GT(norm(sourceShell(solid, 0.03, sources(500, 2))[0] - one[0]), 0);
  for (const double scale : {1e-3, 1e3}) {
    const Vec3 shift = scale * 1000 * solid.diagonal() * Vec3{0.6, -0.64, 0.48};
    const Solid moved(shapes::transformed(mesh, scale, shift));
    const Points points = sourceShell(moved, 0.03, sources(500));
    for (std::size_t i = 0; i < points.size(); ++i)
      ASSERT_LT(norm((points[i] - shift) / scale - one[i]), 1e-6);
  }
}

TEST(SourceShell, SettingsAndCancelling) {
  const Solid solid(shapes::icosphere(2));
  EXPECT_THROW(sourceShell(solid, 0.05, sources(0)), SettingError);
  EXPECT_THROW(sourceShell(solid, 0.05, sources(10'000'001)), SettingError);
  EXPECT_THROW(sourceShell(solid, 0, sources(10)), SettingError);
  EXPECT_THROW(sourceShell(solid, 3, sources(10)), SettingError);
  EXPECT_EQ(sourceShell(solid, 0.05, sources(1)).size(), 1u);
  test::expectCancels([&] { sourceShell(solid, 0.05, {}); });
  test::expectCancels([&] { sourceSphere(solid, 2, {}); });
}

TEST(SourceSphere, IsBlueNoiseOnTheSphere) {
  const Vec3 shift{10, -20, 5};
  const Solid solid(shapes::box(shift, shift + Vec3{1, 2, 3}));
  const std::size_t n = 1000;
  for (const double ratio : {1.0001, 1.5, 100.0}) {
    SCOPED_TRACE(ratio);
    const Points points = sourceSphere(solid, ratio, sources(n));
    ASSERT_EQ(points.size(), n);
    const double r = 0.5 * ratio * solid.diagonal();
    for (const Vec3& p : points) {
      EXPECT_NEAR(norm(p - solid.box().center()), r, 1e-9 * r);
      EXPECT_FALSE(solid.inside(p));
    }
    const double largest = 2 * std::sqrt(4 * kPi * r * r / (2 * std::sqrt(3.0) * n));
    EXPECT_GT(shapes::leastDistance(points), 0.6 * largest);
  }
  for (const double ratio : {1.0, 0.0, -2.0, 101.0, std::nan("")})
    EXPECT_THROW(sourceSphere(solid, ratio, sources(10)), SettingError);
}

}  // namespace
}  // namespace innermap
