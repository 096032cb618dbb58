#include "mesh/triangle_tree.h"

#include <gtest/gtest.h>

#include <set>

#include "core/random.h"
#include "innermap/core/run.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

using shapes::randomPoint;

// Distance to a triangle by minimising over its plane and its three edges, written apart from the
// tree's method.
double referenceDistance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  double best = std::numeric_limits<double>::infinity();
  const Vec3 corners[3] = {a, b, c};
  for (int k = 0; k < 3; ++k) {
    const Vec3 u = corners[k], d = corners[(k + 1) % 3] - u;
    const double length2 = squaredNorm(d);
    const double t = length2 > 0 ? std::clamp(dot(p - u, d) / length2, 0.0, 1.0) : 0;
    best = std::min(best, norm(p - (u + t * d)));
  }
  const Vec3 n = cross(b - a, c - a);
  if (squaredNorm(n) > 0) {
    const Vec3 q = p - (dot(p - a, n) / squaredNorm(n)) * n;
    bool within = true;
    for (int k = 0; k < 3; ++k)
      within = within && dot(cross(corners[(k + 1) % 3] - corners[k], q - corners[k]), n) >= 0;
    if (within) best = std::min(best, norm(p - q));
  }
  return best;
}

double referenceDistance(const Mesh& mesh, const Vec3& p) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& [i, j, k] : mesh.triangles) {
    best =
        std::min(best, referenceDistance(p, mesh.vertices[i], mesh.vertices[j], mesh.vertices[k]));
  }
  return best;
}

Vec3 positionAt(const Mesh& mesh, const SurfacePoint& s) {
  Vec3 sum;
  for (int k = 0; k < 3; ++k)
    sum += s.barycentric[k] * mesh.vertices[mesh.triangles[s.triangle][k]];
  return sum;
}

TEST(TriangleTree, ClosestAgreesWithAllTriangles) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    for (const double size : {0.001, 0.1, 2.0}) {
      SCOPED_TRACE(::testing::Message() << "seed " << seed << " size " << size);
      const Mesh mesh = shapes::soup(400, size, seed);
      const TriangleTree tree(mesh.vertices, mesh.triangles);
      const CounterRandom random(seed, 5);
      for (int i = 0; i < 400; ++i) {
        const Vec3 p = (i % 4 == 0 ? 10 : 1.2) * randomPoint(random, i);
        const double expected = referenceDistance(mesh, p);
        const ClosestPoint found = tree.closest(p);
        ASSERT_GE(found.address.triangle, 0);
        EXPECT_NEAR(found.distance, expected, 1e-13 * (1 + expected));
        EXPECT_NEAR(norm(p - found.position), found.distance, 1e-13 * (1 + expected));
        EXPECT_LT(norm(positionAt(mesh, found.address) - found.position), 1e-14 * 16);
        EXPECT_TRUE(tree.hasCloser(p, found.distance * (1 + 1e-12) + 1e-12));
        EXPECT_FALSE(tree.hasCloser(p, found.distance * (1 - 1e-12)));
        for (const double b : found.address.barycentric) {
          EXPECT_GE(b, -1e-15);
          EXPECT_LE(b, 1 + 1e-15);
        }
      }
    }
  }
}

// Places in a ball: the part about its centre, and of that the part about a smaller ball's.
TEST(TriangleTree, PartsHoldWhatIsClosestInABall) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const Mesh mesh = shapes::soup(400, seed == 2 ? 2.0 : 0.1, seed);
    const TriangleTree tree(mesh.vertices, mesh.triangles);
    const CounterRandom random(seed, 6);
    TriangleTree::Part part, smaller;
    for (std::uint64_t i = 0; i < 300; ++i) {
      const Vec3 center = 1.2 * randomPoint(random, 3 * i);
      const double radius = 0.1;
      tree.collect(center, tree.closest(center).distance + 2.001 * radius, part);
      const Vec3 within = center + 0.4 * radius * randomPoint(random, 3 * i + 1);
      tree.collect(within, tree.closest(within).distance + 0.201 * radius, part, smaller);
      EXPECT_LE(smaller.size(), part.size());
      const Vec3 p = within + 0.05 * radius * randomPoint(random, 3 * i + 2);
      const ClosestPoint found = tree.closest(p), inPart = tree.closest(p, 10, smaller);
      EXPECT_EQ(inPart.address.triangle, found.address.triangle);
      EXPECT_EQ(inPart.distance, found.distance);  // the same sums
      EXPECT_EQ(tree.closest(p, 0.999 * found.distance, smaller).address.triangle, -1);
    }
  }
}

TEST(TriangleTree, RadiusBoundsTheSearch) {
  const Mesh mesh = shapes::icosphere(3);
  const TriangleTree tree(mesh.vertices, mesh.triangles);
  EXPECT_EQ(tree.size(), mesh.triangles.size());
  const CounterRandom random(4, 4);
  for (int i = 0; i < 200; ++i) {
    const Vec3 p = 1.5 * randomPoint(random, i);
    const ClosestPoint far = tree.closest(p);
    EXPECT_EQ(tree.closest(p, 0.999 * far.distance).address.triangle, -1);
    const ClosestPoint near = tree.closest(p, 1.001 * far.distance);
    EXPECT_EQ(near.address.triangle, far.address.triangle);
    EXPECT_EQ(near.distance, far.distance);
  }
}

TEST(TriangleTree, LowestIndexWinsAmongEquals) {
  // A fan of triangles around one vertex, points beyond it.
  Mesh mesh;
  mesh.vertices.push_back({0, 0, 1});
  const int n = 64;
  for (int i = 0; i < n; ++i) {
    const double u = 2 * kPi * i / n;
    mesh.vertices.push_back({std::cos(u), std::sin(u), 0});
  }
  for (int i = 0; i < n; ++i) mesh.triangles.push_back({0, 1 + (i + 17) % n, 1 + (i + 18) % n});
  const TriangleTree tree(mesh.vertices, mesh.triangles);
  const CounterRandom random(9, 9);
  for (int i = 0; i < 100; ++i) {
    const Vec3 p = Vec3{0, 0, 3} + 0.3 * randomPoint(random, i);
    EXPECT_EQ(tree.closest(p).address.triangle, 0);
  }
}

TEST(TriangleTree, DegenerateTriangles) {
  // Points, segments and needles; distances as to segments.
  Mesh mesh;
  const CounterRandom random(21, 3);
  for (int t = 0; t < 120; ++t) {
    const Vec3 a = randomPoint(random, 4 * t), b = randomPoint(random, 4 * t + 1);
    const double s = random.uniform(100000 + t) * 2 - 0.5;
    const Vec3 needle = std::pow(10.0, -6 - t % 12) * randomPoint(random, 4 * t + 2);
    const Vec3 c = t % 4 == 0 ? a : t % 4 == 1 ? a + s * (b - a) : a + s * (b - a) + needle;
    mesh.vertices.insert(mesh.vertices.end(), {a, t % 8 == 0 ? a : b, c});
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  const TriangleTree tree(mesh.vertices, mesh.triangles);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = randomPoint(random, 1000 + i);
    const ClosestPoint found = tree.closest(p);
    ASSERT_GE(found.address.triangle, 0);
    EXPECT_NEAR(found.distance, referenceDistance(mesh, p), 1e-11);
    EXPECT_LT(norm(positionAt(mesh, found.address) - found.position), 1e-14);
  }
}

TEST(TriangleTree, CoincidentTrianglesDoNotDeepenTheTree) {
  Mesh mesh{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  mesh.triangles.assign(5000, {0, 1, 2});
  const TriangleTree tree(mesh.vertices, mesh.triangles);
  const ClosestPoint found = tree.closest({0.25, 0.25, 2});
  EXPECT_EQ(found.address.triangle, 0);
  EXPECT_DOUBLE_EQ(found.distance, 2);
}

TEST(TriangleTree, GeometricSizesAndSpacingsDoNotDeepenTheTree) {
  // Each triangle half as large and half as far as the one before: the worst case for splits.
  Mesh mesh;
  for (int t = 0; t < 900; ++t) {
    const double s = std::ldexp(1.0, -t);
    mesh.vertices.insert(mesh.vertices.end(), {{s, 0, 0}, {1.1 * s, 0, 0}, {s, 0.1 * s, 0}});
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  const TriangleTree tree(mesh.vertices, mesh.triangles);
  EXPECT_EQ(tree.closest({1, 0, 1}).address.triangle, 0);
  // From behind, all beyond about the 53rd are equally far in double precision.
  EXPECT_NEAR(tree.closest({-1, 0, 0}).address.triangle, 53, 2);
}

TEST(TriangleTree, ScaleAndPlaceDoNotMatter) {
  const Mesh mesh = shapes::torus(40, 20);
  const TriangleTree tree(mesh.vertices, mesh.triangles);
  for (const double scale : {1e-150, 1e-3, 1e3, 1e150}) {
    const Mesh moved = shapes::transformed(mesh, scale, {});
    const TriangleTree other(moved.vertices, moved.triangles);
    const CounterRandom random(8, 1);
    for (int i = 0; i < 100; ++i) {
      const Vec3 p = 2 * randomPoint(random, i);
      EXPECT_NEAR(other.closest(scale * p).distance / scale, tree.closest(p).distance, 1e-14);
    }
  }
}

TEST(TriangleTree, NothingToFind) {
  const TriangleTree none({}, {});
  EXPECT_EQ(none.closest({1, 2, 3}).address.triangle, -1);
  none.overlappingPairs([](std::size_t, int, int) { FAIL(); }, [] { FAIL(); });
  const Mesh mesh = shapes::icosphere(1);
  const TriangleTree tree(mesh.vertices, mesh.triangles);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(tree.closest({nan, 0, 0}).address.triangle, -1);
  EXPECT_EQ(tree.closest({2, 0, 0}, 0).address.triangle, -1);
}

// In their order.
std::vector<std::pair<int, int>> overlappingPairs(const Mesh& mesh) {
  std::vector<std::pair<int, int>> out;
  std::vector<std::vector<std::pair<int, int>>> parts(TriangleTree::kParts);
  TriangleTree(mesh.vertices, mesh.triangles)
      .overlappingPairs(
          [&](std::size_t part, int i, int j) {
            parts.at(part).push_back({i, j});
          },
          [&] {
            for (auto& part : parts) {
              out.insert(out.end(), part.begin(), part.end());
              part.clear();
            }
          });
  return out;
}

TEST(TriangleTree, OverlappingPairsComeInOneOrderForAnyNumberOfThreads) {
  const Mesh mesh = shapes::soup(20000, 0.06, 13);
  const std::vector<std::pair<int, int>> all = overlappingPairs(mesh);
  EXPECT_GT(all.size(), 20000u);
  const ThreadLimit one(1);
  EXPECT_EQ(overlappingPairs(mesh), all);
}

TEST(TriangleTree, OverlappingPairsAreAllPairsOfOverlappingBoxes) {
  for (const std::uint64_t seed : {11, 12}) {
    SCOPED_TRACE(seed);
    const Mesh mesh = shapes::soup(300, 0.15, seed);
    const std::vector<std::pair<int, int>> all = overlappingPairs(mesh);
    const std::set<std::pair<int, int>> found(all.begin(), all.end());
    EXPECT_EQ(all.size(), found.size());
    std::set<std::pair<int, int>> expected;
    std::vector<Box3> boxes(300);
    for (int t = 0; t < 300; ++t)
      for (const int v : mesh.triangles[t]) boxes[t].add(mesh.vertices[v]);
    for (int i = 0; i < 300; ++i) {
      for (int j = i + 1; j < 300; ++j) {
        bool overlap = true;
        for (int a = 0; a < 3; ++a) {
          overlap = overlap && boxes[i].lower[a] <= boxes[j].upper[a] &&
                    boxes[j].lower[a] <= boxes[i].upper[a];
        }
        if (overlap) expected.insert({i, j});
      }
    }
    EXPECT_GT(expected.size(), 100u);
    EXPECT_EQ(found, expected);
  }
}

}  // namespace
}  // namespace innermap
