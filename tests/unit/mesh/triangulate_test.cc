#include "mesh/triangulate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/pi.h"
#include "core/random.h"

namespace innermap {
namespace {

std::vector<Triangle> cut(const Points& v, const std::vector<int>& corners) {
  std::vector<Triangle> local;
  triangulatePolygon(v, corners.data(), static_cast<int>(corners.size()), local);
  for (Triangle& t : local)
    for (int& k : t) k = corners[k];
  return local;
}

double area2(const Points& v, const Triangle& t) {
  return cross(v[t[1]] - v[t[0]], v[t[2]] - v[t[0]]).z;
}

TEST(Triangulate, TriangleStaysAsItIs) {
  EXPECT_EQ(cut({{}, {1, 0, 0}, {0, 1, 0}}, {2, 0, 1}), (std::vector<Triangle>{{2, 0, 1}}));
}

TEST(Triangulate, ConvexPolygonIsAFanFromTheLowestIndex) {
  const Points v{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<Triangle> expected{{0, 1, 2}, {0, 2, 3}};
  EXPECT_EQ(cut(v, {0, 1, 2, 3}), expected);
  EXPECT_EQ(cut(v, {2, 3, 0, 1}), expected);
}

TEST(Triangulate, ConcaveQuadIsCutAtItsNotch) {
  const Points v{{0, 0, 0}, {2, -1, 0}, {0.5, 0, 0}, {2, 1, 0}};  // notch at 2
  for (const Triangle& t : cut(v, {0, 1, 2, 3})) EXPECT_GT(area2(v, t), 0);
  const Points w{{2, -1, 0}, {0.5, 0, 0}, {2, 1, 0}, {0, 0, 0}};  // fan from 0 would be wrong
  for (const Triangle& t : cut(w, {0, 1, 2, 3})) EXPECT_GT(area2(w, t), 0);
}

// Star-shaped polygons with random radii: the exact triangulation has positive triangles that add
// up to the polygon's area, wherever the polygon begins in the file.
TEST(Triangulate, RandomConcavePolygons) {
  for (int seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    const CounterRandom random(seed, 1);
    const int count = 5 + seed % 40;
    Points v;
    double area = 0;
    for (int k = 0; k < count; ++k) {
      const double angle = 2 * kPi * k / count, r = 0.2 + random.uniform(k);
      v.push_back({r * std::cos(angle), r * std::sin(angle), 0.01 * random.uniform(1000 + k)});
    }
    for (int k = 0; k < count; ++k) area += cross(v[k], v[(k + 1) % count]).z;
    std::vector<int> corners(count);
    std::iota(corners.begin(), corners.end(), 0);
    const std::vector<Triangle> triangles = cut(v, corners);
    ASSERT_EQ(triangles.size(), corners.size() - 2);
    double sum = 0;
    for (const Triangle& t : triangles) {
      EXPECT_GT(area2(v, t), -1e-3);  // the mean plane is not quite z = 0
      sum += area2(v, t);
    }
    EXPECT_NEAR(sum, area, 1e-9);
    std::rotate(corners.begin(), corners.begin() + seed % count, corners.end());
    EXPECT_EQ(cut(v, corners), triangles);
  }
}

TEST(Triangulate, StarAndFlatPolygonsFallBackToTheFan) {
  Points star;
  for (int k = 0; k < 5; ++k)
    star.push_back({std::cos(4 * kPi * k / 5), std::sin(4 * kPi * k / 5), 0});
  EXPECT_EQ(cut(star, {0, 1, 2, 3, 4}).size(), 3u);
  const Points flat{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  EXPECT_EQ(cut(flat, {0, 1, 2, 3}), (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  const Points point(6);
  EXPECT_EQ(cut(point, {0, 1, 2, 3, 4, 5}).size(), 4u);
}

// A comb of many teeth and a spiral: simple, far from star-shaped.
TEST(Triangulate, CombsAndSpirals) {
  Points comb, spiral;
  for (int k = 0; k < 300; ++k) comb.push_back({double(k), k % 2 ? 5.0 : 0.1, 0});
  comb.push_back({299, -1, 0});
  comb.push_back({0, -1, 0});
  const auto turn = [](double r, double angle) {
    return Vec3{r * std::cos(angle), r * std::sin(angle), 0};
  };
  for (int k = 0; k < 200; ++k) spiral.push_back(turn(1 + 0.02 * k, 0.2 * k));
  for (int k = 199; k >= 0; --k) spiral.push_back(turn(0.8 + 0.02 * k, 0.2 * k));
  for (Points polygon : {comb, spiral}) {
    double area = 0, sum = 0;
    const std::size_t count = polygon.size();
    for (std::size_t k = 0; k < count; ++k) area += cross(polygon[k], polygon[(k + 1) % count]).z;
    if (area < 0) std::reverse(polygon.begin(), polygon.end());
    std::vector<int> corners(count);
    std::iota(corners.begin(), corners.end(), 0);
    for (const Triangle& t : cut(polygon, corners)) {
      EXPECT_GE(area2(polygon, t), 0);
      sum += area2(polygon, t);
    }
    EXPECT_NEAR(sum, std::abs(area), 1e-9);
  }
}

TEST(Triangulate, HugePolygonIsQuick) {
  Points v;
  std::vector<int> corners;
  for (int k = 0; k < 200000; ++k) {
    v.push_back({double(k), k % 2 ? 1.0 : 0.0, 0});
    corners.push_back(k);
  }
  EXPECT_EQ(cut(v, corners).size(), corners.size() - 2);
}

}  // namespace
}  // namespace innermap
