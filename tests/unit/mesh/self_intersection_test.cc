#include <gtest/gtest.h>

#include <set>

#include "core/expect.h"
#include "core/pi.h"
#include "core/random.h"
#include "innermap/mesh/check.h"
#include "mesh/test_meshes.h"

namespace innermap {
namespace {

using Integer = std::int64_t;
using Corners = std::array<std::array<Integer, 3>, 3>;

// Exact, coordinates being small whole numbers.
int side(const Corners& t, const std::array<Integer, 3>& p) {
  Integer m[3][3];
  for (int i = 0; i < 3; ++i)
    for (int a = 0; a < 3; ++a) m[i][a] = t[i][a] - p[a];
  const Integer d = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                    m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                    m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return (d > 0) - (d < 0);
}

// Whether segment pq crosses the triangle's inside (2), touches it (1) or misses it (0).
int crosses(const std::array<Integer, 3>& p, const std::array<Integer, 3>& q, const Corners& t) {
  const int product = side(t, p) * side(t, q);
  if (product > 0) return 0;
  int least = 1, most = -1;
  for (int k = 0; k < 3; ++k) {
    const int s = side({p, q, t[k]}, t[(k + 1) % 3]);
    least = std::min(least, s);
    most = std::max(most, s);
  }
  if (least * most < 0) return 0;
  return product < 0 && least * most > 0 ? 2 : 1;
}

int crosses(const Corners& a, const Corners& b) {
  int best = 0;
  for (int k = 0; k < 3; ++k) {
    best = std::max(best, crosses(a[k], a[(k + 1) % 3], b));
    best = std::max(best, crosses(b[k], b[(k + 1) % 3], a));
  }
  return best;
}

std::size_t count(const Mesh& mesh) {
  return selfIntersections(mesh.vertices, mesh.triangles).size();
}

TEST(SelfIntersection, AgreesWithExactArithmetic) {
  int through = 0, apart = 0;
  for (int seed = 0; seed < 20000; ++seed) {
    SCOPED_TRACE(seed);
    const CounterRandom random(seed, 5);
    Corners t[2];
    Points v;
    for (int i = 0; i < 18; ++i) {
      const Integer c = static_cast<Integer>(random.bits(i) % 9);
      t[i / 9][i / 3 % 3][i % 3] = c;
      if (i % 3 == 0) v.emplace_back();
      v.back()[i % 3] = static_cast<double>(c);
    }
    std::set<std::array<Integer, 3>> distinct;
    for (const Corners& corners : t) distinct.insert(corners.begin(), corners.end());
    if (distinct.size() < 6) continue;
    const bool found = selfIntersections(v, {{0, 1, 2}, {3, 4, 5}}).size() == 1;
    const int expected = crosses(t[0], t[1]);
    if (expected != 1) {
      EXPECT_EQ(found, expected == 2);
    }
    through += expected == 2;
    apart += expected == 0;
  }
  EXPECT_GT(through, 1000);
  EXPECT_GT(apart, 1000);
}

TEST(SelfIntersection, SmoothClosedMeshesHaveNone) {
  EXPECT_EQ(count(shapes::icosphere(4)), 0u);
  EXPECT_EQ(count(shapes::torus(40, 20)), 0u);
  EXPECT_EQ(count(testing::exploded(shapes::icosphere(3))), 0u);  // equal positions are shared
}

TEST(SelfIntersection, CubesThroughEachOther) {
  const Mesh mesh = shapes::joined(testing::cube(), testing::cube(1, {0.4, 0.3, 0.6}));
  EXPECT_GT(count(mesh), 0u);
  for (const Crossing& c : selfIntersections(mesh.vertices, mesh.triangles)) {
    EXPECT_LT(c.first, 12);
    EXPECT_GE(c.second, 12);
    for (int a = 0; a < 3; ++a) {  // the place lies in both cubes' boxes
      EXPECT_GE(c.place[a], 0.3 - 1e-12);
      EXPECT_LE(c.place[a], 1 + 1e-12);
    }
  }
  EXPECT_EQ(count(shapes::joined(testing::cube(), testing::cube(0.5, {0.25, 0.25, 0.25}))), 0u);
}

TEST(SelfIntersection, SharedVertexAndSharedEdge) {
  // Both from the origin; the second passes through the first, or is beside it.
  const Points v{{0, 0, 0}, {2, -1, 0}, {2, 1, 0}, {2, 0, -1}, {2, 0.2, 1}, {2, 3, 1}, {2, 3, -1}};
  EXPECT_EQ(selfIntersections(v, {{0, 1, 2}, {0, 3, 4}}).size(), 1u);
  EXPECT_EQ(selfIntersections(v, {{0, 1, 2}, {0, 5, 6}}).size(), 0u);
  // Two triangles on one edge: unfolded, at an angle, folded flat.
  const Points w{{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, -1, 0}, {0.5, 1, 0.001}, {0.5, 2, 0}};
  EXPECT_EQ(selfIntersections(w, {{0, 1, 2}, {1, 0, 3}}).size(), 0u);
  EXPECT_EQ(selfIntersections(w, {{0, 1, 2}, {1, 0, 4}}).size(), 0u);
  EXPECT_EQ(selfIntersections(w, {{0, 1, 2}, {1, 0, 5}}).size(), 1u);
  EXPECT_EQ(selfIntersections(w, {{0, 1, 2}, {2, 1, 0}}).size(), 0u);  // opposite: told elsewhere
  EXPECT_EQ(selfIntersections(w, {{0, 1, 1}, {2, 2, 0}}).size(), 0u);  // degenerate
}

TEST(SelfIntersection, CoplanarTrianglesOverlapOrTouch) {
  const Points v{{0, 0, 1}, {2, 0, 1}, {0, 2, 1}, {0.5, 0.5, 1}, {3, 0.5, 1},
                 {3, 3, 1}, {2, 2, 1}, {1, 1, 1}, {5, 5, 1}};
  EXPECT_EQ(selfIntersections(v, {{0, 1, 2}, {3, 4, 5}}).size(), 1u);
  EXPECT_EQ(selfIntersections(v, {{0, 1, 2}, {1, 6, 2}}).size(), 0u);
  EXPECT_EQ(selfIntersections(v, {{0, 1, 2}, {7, 6, 8}}).size(), 0u);
}

TEST(SelfIntersection, DoesNotDependOnScaleOrThreads) {
  const Mesh mesh = shapes::joined(shapes::icosphere(3), shapes::icosphere(3, 1, {0.7, 0.2, 0.1}));
  const std::size_t expected = count(mesh);
  EXPECT_GT(expected, 50u);
  for (const double scale : {0x1.0p-300, 0x1.0p+300}) {
    Mesh scaled = mesh;
    for (Vec3& p : scaled.vertices) p = scale * p;
    EXPECT_EQ(count(scaled), expected);
  }
  test::expectSameForThreads([&] {
    std::vector<double> places;
    forEachSelfIntersection(mesh.vertices, mesh.triangles,
                            [&](const Crossing& c) { places.push_back(c.place.x); });
    return places;
  });
}

TEST(SelfIntersection, CountsManyWithoutKeepingThemAndCanBeCancelled) {
  // 3000 triangles that all pass through the axis: 4.5 million pairs.
  Mesh mesh;
  const CounterRandom random(1, 1);
  for (int i = 0; i < 3000; ++i) {
    const double angle = kPi * i / 3000, r = 1 + random.uniform(i);
    const Vec3 d{r * std::cos(angle), r * std::sin(angle), 0};
    mesh.vertices.insert(mesh.vertices.end(), {d + Vec3{0, 0, 0.1}, -1.0 * d, Vec3{0, 0, r}});
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  MeshReport report = checkMesh(mesh);
  EXPECT_GT(report.selfIntersections, 3000000u);
  EXPECT_EQ(report.crossings.size(), 20u);
  EXPECT_EQ(report.crossings[0].first, 0);
  test::expectCancels([&] { selfIntersections(mesh.vertices, mesh.triangles); });
}

}  // namespace
}  // namespace innermap
