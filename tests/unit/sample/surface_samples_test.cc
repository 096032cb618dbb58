#include "sample/surface_samples.h"

#include <gtest/gtest.h>

#include <chrono>
#include <set>

#include "core/expect.h"
#include "core/random.h"
#include "mesh/shapes.h"
#include "sample/detail/sample_elimination.h"

namespace innermap {
namespace {

Points positions(const Mesh& mesh, const std::vector<SurfacePoint>& samples) {
  Points points;
  for (const SurfacePoint& s : samples) points.push_back(positionOf(mesh, s));
  return points;
}

bool operator==(const SurfacePoint& x, const SurfacePoint& y) {
  return x.triangle == y.triangle && x.barycentric == y.barycentric;
}

TEST(RandomSamples, UniformByArea) {
  // Areas 1 : 4 : 0 : 20, and places within a triangle by their third coordinate.
  Mesh mesh{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {4, 0, 0}, {0, 4, 5}, {8, 0, 0}},
            .triangles = {{0, 1, 2}, {0, 3, 2}, {1, 1, 2}, {0, 5, 4}}};
  const std::size_t n = 100000;
  const std::vector<SurfacePoint> samples = randomSamples(mesh, n);
  ASSERT_EQ(samples.size(), n);
  std::array<double, 4> counts{};
  std::array<double, 4> corners{};  // samples nearer than halfway to the first corner
  for (const SurfacePoint& s : samples) {
    ++counts[s.triangle];
    corners[s.triangle] += s.barycentric[0] > 0.5;
    EXPECT_NEAR(s.barycentric[0] + s.barycentric[1] + s.barycentric[2], 1, 1e-14);
    for (const double b : s.barycentric) EXPECT_GE(b, 0);
  }
  const double total = surfaceArea(mesh);
  for (int t = 0; t < 4; ++t) {
    const double expected = n * norm(areaVector(mesh, t)) / total;
    EXPECT_NEAR(counts[t], expected, 5 * std::sqrt(expected));
    EXPECT_NEAR(corners[t], expected / 4, 5 * std::sqrt(expected));
  }
}

TEST(RandomSamples, DependOnSeedAndIndexAlone) {
  const Mesh mesh = shapes::icosphere(2);
  const std::vector<SurfacePoint> few = randomSamples(mesh, 100), many = randomSamples(mesh, 20000);
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_TRUE(few[i] == many[i]);
  EXPECT_FALSE(randomSamples(mesh, 1, {.seed = 2})[0] == few[0]);
  EXPECT_TRUE(randomSamples(mesh, 0).empty());
}

TEST(RandomSamples, Refusals) {
  Mesh flat;
  flat.name = "flat.obj";
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  flat.triangles = {{0, 1, 2}};
  EXPECT_THROW(randomSamples(flat, 10), DataError);
  EXPECT_THROW(blueNoiseSamples(flat, 10), DataError);
  EXPECT_THROW(randomSamples(Mesh{}, 10), DataError);
  EXPECT_THROW(randomSamples(shapes::icosphere(1), 100'000'001), SettingError);
  EXPECT_THROW(blueNoiseSamples(shapes::icosphere(1), 100'000'001), SettingError);
  test::expectCancels([&] { blueNoiseSamples(shapes::icosphere(1), 1000, {1}); });
}

TEST(BlueNoise, SamplesKeepTheirDistance) {
  const Mesh mesh = shapes::torus(60, 30);
  for (const std::size_t n : {1u, 2u, 50u, 3000u}) {
    SCOPED_TRACE(n);
    const std::vector<SurfacePoint> samples = blueNoiseSamples(mesh, n);
    ASSERT_EQ(samples.size(), n);
    if (n < 50) continue;
    const double largest = 2 * std::sqrt(surfaceArea(mesh) / (2 * std::sqrt(3.0) * n));
    const Points points = positions(mesh, samples);
    // Yuksel reports 0.7 and more of the hexagonal packing's distance; random ones come to 0.02.
    EXPECT_GT(shapes::leastDistance(points), 0.6 * largest);
    EXPECT_LT(shapes::leastDistance(points), largest);
    // Even density: each octant has its share within a few samples.
    if (n < 3000) continue;
    std::array<int, 8> octants{};
    for (const Vec3& p : points) ++octants[(p.x > 0) + 2 * (p.y > 0) + 4 * (p.z > 0)];
    for (const int count : octants) EXPECT_NEAR(count, n / 8.0, 0.04 * n / 8.0);
  }
}

TEST(BlueNoise, ScaleAndPlaceDoNotMatter) {
  const Mesh mesh = shapes::torus(60, 30);
  const std::vector<SurfacePoint> samples = blueNoiseSamples(mesh, 2000);
  const double diagonal = boundingBox(mesh).diagonal();
  for (const double scale : {1e-3, 1e3}) {
    for (const double far : {0.0, 1000.0}) {
      const Vec3 shift = scale * far * diagonal * Vec3{0.6, -0.64, 0.48};
      const auto moved = blueNoiseSamples(shapes::transformed(mesh, scale, shift), 2000);
      ASSERT_EQ(moved.size(), samples.size());
      for (std::size_t i = 0; i < moved.size(); ++i) {
        ASSERT_EQ(moved[i].triangle, samples[i].triangle);
        for (int k = 0; k < 3; ++k)
          ASSERT_NEAR(moved[i].barycentric[k], samples[i].barycentric[k], 1e-9);
      }
    }
  }
}

TEST(EliminateSamples, KeepsCountInAscendingOrder) {
  const CounterRandom random(1, 1);
  Points points;
  for (int i = 0; i < 500; ++i)
    points.push_back({random.uniform(2 * i), random.uniform(2 * i + 1), 0});
  for (const std::size_t n : {0u, 1u, 77u, 499u, 500u, 1000u}) {
    const std::vector<std::size_t> kept = eliminateSamples(points, n, 1);
    ASSERT_EQ(kept.size(), std::min<std::size_t>(n, 500));
    EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
    EXPECT_EQ(std::set<std::size_t>(kept.begin(), kept.end()).size(), kept.size());
    if (!kept.empty()) {
      EXPECT_LT(kept.back(), 500u);
    }
  }
  EXPECT_TRUE(eliminateSamples({}, 5, 1).empty());
}

TEST(EliminateSamples, OneOfCoincidentPointsStays) {
  const CounterRandom random(1, 2);
  Points points;
  for (int i = 0; i < 200; ++i) {
    const Vec3 p{random.uniform(2 * i), random.uniform(2 * i + 1), 0};
    points.push_back(p);
    points.push_back(p);
  }
  const std::vector<std::size_t> kept = eliminateSamples(points, 50, 1);
  std::set<std::size_t> places;
  for (const std::size_t i : kept) places.insert(i / 2);
  EXPECT_EQ(places.size(), 50u);
}

TEST(EliminateSamples, PilesAndBadAreas) {
  Points points(200000, Vec3{1, 2, 3});
  const auto start = std::chrono::steady_clock::now();
  for (const double area : {0.0, 1.0, -1.0, std::nan(""), 1e-300})
    EXPECT_EQ(eliminateSamples(points, 40000, area).size(), 40000u);
  for (std::size_t i = 0; i < 1000; ++i) points[i].x += 1e-3 * static_cast<double>(i);
  for (const double area : {0.0, 1.0, 1e10, 1e-300}) {
    const std::vector<std::size_t> kept = eliminateSamples(points, 2000, area);
    EXPECT_EQ(kept.size(), 2000u);
  }
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  EXPECT_LT(seconds.count(), 30);  // the square of their number would take minutes
}

}  // namespace
}  // namespace innermap
