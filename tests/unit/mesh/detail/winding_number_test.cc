#include "mesh/winding_number.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "mesh/shapes.h"
#include "mesh/triangle_tree.h"

namespace innermap {
namespace {

using shapes::randomPoint;

TEST(WindingNumber, ClosedSurfaceSeparatesInsideFromOutside) {
  const Mesh mesh = shapes::torus(60, 30);
  const WindingNumber winding(mesh.vertices, mesh.triangles);
  const CounterRandom random(3, 1);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = 1.5 * randomPoint(random, i);
    const double q = std::hypot(std::hypot(p.x, p.y) - 1, p.z);
    if (std::abs(q - 0.35) < 0.01) continue;
    const double expected = q < 0.35 ? 1 : 0;
    EXPECT_NEAR(winding.exactAt(p), expected, 1e-12);
    EXPECT_NEAR(winding.at(p), expected, 1e-2);
  }
}

TEST(WindingNumber, CountsCoversAndTurns) {
  const Mesh ball = shapes::icosphere(3);
  const Mesh twice = shapes::joined(ball, shapes::icosphere(2, 0.5));
  EXPECT_NEAR(WindingNumber(twice.vertices, twice.triangles).at({0.1, 0, 0}), 2, 1e-2);
  const Mesh turned = shapes::flipped(ball);
  EXPECT_NEAR(WindingNumber(turned.vertices, turned.triangles).at({0.1, 0, 0}), -1, 1e-2);
  // Many covers: more than one turn in the sum of a leaf.
  Mesh many;
  for (int i = 0; i < 40; ++i) many = i == 0 ? ball : shapes::joined(many, ball);
  const WindingNumber winding(many.vertices, many.triangles);
  EXPECT_NEAR(winding.exactAt({0.1, 0.2, 0}), 40, 1e-10);
  EXPECT_NEAR(winding.at({0.1, 0.2, 0}), 40, 40 * 1e-2);
}

TEST(WindingNumber, OneTriangleHasTheClosedFormOfAnOctant) {
  const Points vertices{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const WindingNumber winding(vertices, {{0, 1, 2}});
  EXPECT_NEAR(winding.at({0, 0, 0}), 1.0 / 8, 1e-15);
  EXPECT_NEAR(winding.exactAt({0, 0, 0}), 1.0 / 8, 1e-15);
  // On either side of the triangle, next to it: half a turn.
  const Vec3 n{1 / std::sqrt(3.0), 1 / std::sqrt(3.0), 1 / std::sqrt(3.0)};
  const Vec3 m{1.0 / 3, 1.0 / 3, 1.0 / 3};
  EXPECT_NEAR(winding.at(m - 1e-9 * n), 0.5, 1e-8);
  EXPECT_NEAR(winding.at(m + 1e-9 * n), -0.5, 1e-8);
}

TEST(WindingNumber, AgreesWithTheExactSumOnSoups) {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    for (const double size : {0.01, 0.1, 0.5}) {
      SCOPED_TRACE(::testing::Message() << "seed " << seed << " size " << size);
      const Mesh mesh = shapes::soup(2000, size, seed);
      const WindingNumber winding(mesh.vertices, mesh.triangles);
      const CounterRandom random(seed, 6);
      double largest = 0;
      for (int i = 0; i < 1000; ++i) {
        const double reach = i % 3 == 0 ? 4 : i % 3 == 1 ? 1 : 0.1;
        const Vec3 p = reach * randomPoint(random, i);
        largest = std::max(largest, std::abs(winding.at(p) - winding.exactAt(p)));
      }
      EXPECT_LT(largest, 1e-2);
      EXPECT_GT(largest, 0);  // otherwise nothing was expanded
    }
  }
}

TEST(WindingNumber, OfATreeIsThatOfItsTriangles) {
  const Mesh closed = shapes::joined(shapes::icosphere(3), shapes::icosphere(2, 0.5));
  // A tree leaves this triangle out; whole numbers are then at()'s, rounded, not counted by a ray.
  Mesh odd = closed;
  odd.vertices.push_back({std::nan(""), 0, 0});
  odd.triangles.insert(odd.triangles.begin(), {0, 1, static_cast<int>(odd.vertices.size()) - 1});
  for (const Mesh& mesh : {closed, odd}) {
    const WindingNumber alone(mesh.vertices, mesh.triangles);
    const WindingNumber shared(TriangleTree(mesh.vertices, mesh.triangles), mesh.triangles);
    const CounterRandom random(5, 6);
    for (int i = 0; i < 200; ++i) {
      const Vec3 p = 1.5 * randomPoint(random, i);
      EXPECT_DOUBLE_EQ(shared.at(p), alone.at(p));
      EXPECT_EQ(shared.wholeAt(p), alone.wholeAt(p));
      EXPECT_NEAR(shared.at(p), shared.exactAt(p), 2e-2);
    }
  }
}

TEST(WindingNumber, AgreesNearTheSurface) {
  const Mesh mesh = shapes::icosphere(5);
  const WindingNumber winding(mesh.vertices, mesh.triangles);
  const CounterRandom random(5, 2);
  for (int i = 0; i < 2000; ++i) {
    const Triangle& t = mesh.triangles[random.bits(i) % mesh.triangles.size()];
    const Vec3 m = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3;
    const double offset = std::pow(10.0, -1.0 - i % 10);
    EXPECT_NEAR(winding.at((1 - offset) * m), 1, 1e-2);
    EXPECT_NEAR(winding.at((1 + offset) * m), 0, 1e-2);
  }
}

TEST(WindingNumber, WholeNumbersOfClosedMeshes) {
  // Overlapping balls, one of them inside out.
  Mesh mesh = shapes::joined(shapes::icosphere(4), shapes::icosphere(3, 0.8, {0.7, 0, 0}));
  mesh = shapes::joined(mesh, shapes::flipped(shapes::icosphere(3, 0.5, {0, 0.9, 0})));
  const WindingNumber winding(mesh.vertices, mesh.triangles);
  const CounterRandom random(15, 2);
  for (int i = 0; i < 5000; ++i) {
    const Vec3 p = 1.6 * randomPoint(random, i);
    const double exact = winding.exactAt(p);
    ASSERT_NEAR(exact, std::round(exact), 1e-9);
    EXPECT_EQ(winding.wholeAt(p), std::lround(exact));
  }
}

// Closed: tetrahedra with corners on a lattice, some of them flat or inside out; their faces share
// planes, lines and corners.
Mesh latticeTetrahedra(int count, int across, std::uint64_t seed) {
  const CounterRandom random(seed, 4);
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const int first = 4 * i;
    for (int k = 0; k < 12; k += 3) {
      const auto coordinate = [&](int a) {
        return static_cast<double>(random.bits(12 * i + k + a) % (across + 1));
      };
      mesh.vertices.push_back({coordinate(0), coordinate(1), coordinate(2)});
    }
    for (const Triangle& t : {Triangle{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}})
      mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return mesh;
}

TEST(WindingNumber, WholeNumbersWhereRaysMeetEdgesAndVertices) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const Mesh mesh = latticeTetrahedra(40, 6, seed);
    const WindingNumber winding(mesh.vertices, mesh.triangles);
    const TriangleTree surface(mesh.vertices, mesh.triangles);
    int met = 0;
    // Along the axis that rays take, most of these meet an edge or a vertex.
    for (int i = 0; i < 7 * 7 * 24; ++i) {
      const int x = i / 49;
      const int y = i / 7 % 7;
      const int z = i % 7;
      const Vec3 p{0.25 * x + 0.125, static_cast<double>(y), static_cast<double>(z)};
      if (surface.closest(p).distance < 1e-6) continue;
      ++met;
      EXPECT_EQ(winding.wholeAt(p), std::lround(winding.exactAt(p)))
          << p.x << " " << p.y << " " << p.z;
    }
    EXPECT_GT(met, 800);
  }
}

TEST(WindingNumber, WholeNumbersNextToTheSurface) {
  const Mesh mesh = shapes::icosphere(5, 1, {3, 2, 1});
  const WindingNumber winding(mesh.vertices, mesh.triangles);
  const CounterRandom random(5, 3);
  for (int i = 0; i < 2000; ++i) {
    const Triangle& t = mesh.triangles[random.bits(i) % mesh.triangles.size()];
    const Vec3 m = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3;
    const Vec3 out = std::pow(10.0, -1.0 - i % 14) * (m - Vec3{3, 2, 1});
    EXPECT_EQ(winding.wholeAt(m - out), 1);
    EXPECT_EQ(winding.wholeAt(m + out), 0);
  }
}

TEST(WindingNumber, OfAnOpenMeshRounded) {
  Mesh mesh = shapes::icosphere(3);
  mesh.triangles.resize(mesh.triangles.size() - 3);
  const WindingNumber winding(mesh.vertices, mesh.triangles);
  const CounterRandom random(6, 1);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = 1.3 * randomPoint(random, i);
    EXPECT_EQ(winding.wholeAt(p), std::lround(winding.at(p)));
  }
}

TEST(WindingNumber, ScaleAndPlaceDoNotMatter) {
  const Mesh mesh = shapes::torus(40, 20);
  const CounterRandom random(8, 1);
  for (const double scale : {1e-150, 1e-3, 1e3, 1e150}) {
    const Vec3 shift = scale * Vec3{3000, -2000, 1000};
    const Mesh moved = shapes::transformed(mesh, scale, shift);
    const WindingNumber winding(moved.vertices, moved.triangles);
    for (int i = 0; i < 300; ++i) {
      const Vec3 p = 1.5 * randomPoint(random, i);
      const double q = std::hypot(std::hypot(p.x, p.y) - 1, p.z);
      if (std::abs(q - 0.35) < 0.02) continue;
      EXPECT_NEAR(winding.at(shift + scale * p), q < 0.35 ? 1 : 0, 1e-2) << scale;
    }
  }
}

TEST(WindingNumber, TinyClusterInALargeMesh) {
  // A closed ball 1e-7 of the mesh across, far from its centre: expansions of small clusters keep
  // their digits.
  const Vec3 place{5, 3, 2};
  const Mesh mesh = shapes::joined(shapes::icosphere(2, 10), shapes::icosphere(3, 1e-6, place));
  const WindingNumber winding(mesh.vertices, mesh.triangles);
  const CounterRandom random(2, 2);
  for (int i = 0; i < 300; ++i) {
    const Vec3 d = randomPoint(random, i);
    if (std::abs(norm(d) - 1) < 0.05) continue;
    EXPECT_NEAR(winding.at(place + 1e-6 * d), norm(d) < 1 ? 2 : 1, 1e-2);
  }
}

TEST(WindingNumber, DegenerateTrianglesAddNothing) {
  Mesh mesh = shapes::icosphere(2);
  mesh.triangles.push_back({0, 0, 5});
  mesh.triangles.push_back({3, 3, 3});
  const WindingNumber winding(mesh.vertices, mesh.triangles);
  const CounterRandom random(1, 2);
  for (int i = 0; i < 100; ++i) {
    const Vec3 p = 0.5 * randomPoint(random, i);
    EXPECT_NEAR(winding.at(p), 1, 1e-2);
    EXPECT_NEAR(winding.exactAt(p), 1, 1e-12);
  }
  EXPECT_EQ(WindingNumber({}, {}).at({0, 0, 0}), 0);
}

}  // namespace
}  // namespace innermap
