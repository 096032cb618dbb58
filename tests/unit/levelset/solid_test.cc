#include "innermap/levelset/solid.h"

#include <gtest/gtest.h>

#include "core/expect.h"
#include "core/random.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

using shapes::randomPoint;

double boxDistance(const Vec3& p, const Vec3& half) {
  const Vec3 q{std::abs(p.x) - half.x, std::abs(p.y) - half.y, std::abs(p.z) - half.z};
  const Vec3 out{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)};
  return norm(out) + std::min(std::max({q.x, q.y, q.z}), 0.0);
}

// Each address on the repaired mesh is the point it was made from, and the surface is exposed: just
// its back is inside, but for pieces that a cut runs through, which are told as a whole.
void expectExposedPieces(const Solid& solid) {
  const CounterRandom random(31, 1);
  const Mesh& surface = solid.surface();
  double wrong = 0, total = 0;
  for (int i = 0; i < 20000; ++i) {
    const int t = static_cast<int>(random.bits(4 * i) % surface.triangles.size());
    const double r = std::sqrt(random.uniform(4 * i + 1)), s = random.uniform(4 * i + 2);
    const SurfacePoint point{t, {1 - r, r * (1 - s), r * s}};
    const Vec3 p = positionOf(surface, point);
    EXPECT_LT(norm(positionOf(solid.repaired().mesh, solid.address(point)) - p),
              1e-12 * solid.diagonal());
    const double area = norm(areaVector(surface, t));
    const Vec3 n = areaVector(surface, t) / area;
    const double offset = 1e-7 * solid.diagonal();
    total += area;
    if (solid.inside(p + offset * n) || !solid.inside(p - offset * n)) wrong += area;
  }
  EXPECT_LE(wrong, solid.gap() > 0 ? 2e-3 * total : 0);
}

TEST(Solid, CleanMeshIsItsOwnSurface) {
  const Mesh mesh = shapes::box({-1, -2, -0.5}, {1, 2, 0.5});
  const Solid solid(mesh);
  EXPECT_FALSE(solid.overlaps());
  EXPECT_EQ(solid.gap(), 0);
  EXPECT_EQ(solid.surface().triangles, mesh.triangles);
  EXPECT_NEAR(solid.volume(), 8, 1e-12);
  EXPECT_NEAR(solid.area(), 28, 1e-12);
  EXPECT_NEAR(solid.diagonal(), std::sqrt(21.0), 1e-12);
  const SurfacePoint s = solid.address({3, {0.25, 0.25, 0.5}});
  EXPECT_EQ(s.triangle, 3);
  EXPECT_EQ(s.barycentric[2], 0.5);
  expectExposedPieces(solid);
  const CounterRandom random(7, 7);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = 3 * randomPoint(random, i);
    EXPECT_NEAR(solid.signedDistance(p), boxDistance(p, {1, 2, 0.5}), 1e-13);
  }
}

TEST(Solid, BallInsideABallIsBuried) {
  const Mesh outer = shapes::icosphere(3);
  const Solid solid(shapes::joined(outer, shapes::icosphere(2, 0.4, {0.3, 0, 0})));
  EXPECT_TRUE(solid.overlaps());
  EXPECT_EQ(solid.surface().triangles, outer.triangles);
  EXPECT_NEAR(solid.volume(), signedVolume(outer), 1e-12);
  EXPECT_TRUE(solid.inside({0.3, 0, 0}));
  EXPECT_NEAR(solid.signedDistance({0.3, 0, 0}), -0.7, 0.02);
  expectExposedPieces(solid);
}

TEST(Solid, CavityIsKept) {
  const Mesh outer = shapes::icosphere(3), inner = shapes::icosphere(3, 0.5);
  const Solid solid(shapes::joined(outer, shapes::flipped(inner)));
  EXPECT_FALSE(solid.overlaps());
  EXPECT_NEAR(solid.volume(), signedVolume(outer) - signedVolume(inner), 1e-12);
  EXPECT_FALSE(solid.inside({0, 0, 0}));
  EXPECT_TRUE(solid.inside({0.75, 0, 0}));
}

TEST(Solid, DoubledSurfaceCountsOnce) {
  const Mesh ball = shapes::icosphere(3);
  const Solid solid(shapes::joined(ball, ball));
  EXPECT_NEAR(solid.area(), surfaceArea(ball), 1e-9);
  EXPECT_NEAR(solid.volume(), signedVolume(ball), 1e-9);
}

TEST(Solid, OverlappingBoxesFormTheirUnion) {
  // Crossing edges, no faces in one plane.
  const Solid solid(shapes::joined(shapes::box({0, 0, 0}, {2, 1, 1}),
                                   shapes::box({1.3, 0.4, 0.3}, {3.1, 1.7, 0.8})));
  EXPECT_TRUE(solid.overlaps());
  const double common = 0.7 * 0.6 * 0.5;
  const double volume = 2 + 1.8 * 1.3 * 0.5 - common;
  EXPECT_NEAR(solid.volume(), volume, 1e-3 * volume);
  const double area = 10 + 2 * (1.8 * 1.3 + 1.8 * 0.5 + 1.3 * 0.5);
  // The part of each box's surface within the other.
  const double buried = (0.6 * 0.5 + 0.7 * 0.5) + (0.6 * 0.5 + 0.7 * 0.5 + 2 * 0.7 * 0.6);
  EXPECT_NEAR(solid.area(), area - buried, 2e-3 * area);
  EXPECT_LE(solid.gap(), solid.diagonal() / 1000);
  EXPECT_GT(solid.gap(), 0);
  EXPECT_TRUE(solid.inside({1.5, 0.7, 0.5}));
  // In the overlap, distance is to the exposed surface only.
  EXPECT_NEAR(solid.distance({1.65, 0.5, 0.5}), std::hypot(0.35, 0.1), 1e-3);
  expectExposedPieces(solid);
}

TEST(Solid, BoxesWithFacesInOnePlane) {
  // Side by side: the touching faces are within the solid.
  const Solid solid(shapes::joined(shapes::box({0, 0, 0}, {1, 1, 1}),
                                   shapes::box({1, 0.25, 0.25}, {2, 1, 0.75})));
  const double volume = 1 + 0.75 * 0.5;
  EXPECT_NEAR(solid.volume(), volume, 5e-3 * volume);
  EXPECT_TRUE(solid.inside({0.99, 0.5, 0.5}));
  EXPECT_TRUE(solid.inside({1.01, 0.5, 0.5}));
}

TEST(Solid, VolumeByLevelSetWhereThePiecesAreLarge) {
  const Solid solid(shapes::joined(shapes::box({0, 0, 0}, {2, 1, 1}),
                                   shapes::box({1.3, 0.4, 0.3}, {3.1, 1.7, 0.8})),
                    {.pieceSize = 0.05});
  const double volume = 2 + 1.8 * 1.3 * 0.5 - 0.7 * 0.6 * 0.5;
  EXPECT_NEAR(solid.volume(), volume, 5e-3 * volume);
}

TEST(Solid, SmallBallThroughTheSurface) {
  const double r = 0.1;
  const Mesh big = shapes::icosphere(4), small = shapes::icosphere(2, r, {1, 0, 0});
  const Solid solid(shapes::joined(big, small));
  EXPECT_TRUE(solid.overlaps());
  // About half of the small ball sticks out.
  const double out = (solid.volume() - signedVolume(big)) / signedVolume(small);
  EXPECT_GT(out, 0.4);
  EXPECT_LT(out, 0.65);
  expectExposedPieces(solid);
}

TEST(Solid, HolesAreCapped) {
  Mesh mesh = shapes::icosphere(4);
  const Mesh whole = mesh;
  std::vector<Triangle> kept;
  for (const Triangle& t : mesh.triangles)
    if (mesh.vertices[t[0]].z < 0.8) kept.push_back(t);
  mesh.triangles = kept;
  const Solid solid(mesh);
  EXPECT_EQ(solid.repaired().caps, 1);
  EXPECT_FALSE(solid.overlaps());
  EXPECT_TRUE(solid.inside({0, 0, 0.7}));
  EXPECT_FALSE(solid.inside({0, 0, 0.95}));
  EXPECT_LT(solid.volume(), signedVolume(whole));
  EXPECT_GT(solid.volume(), 0.9 * signedVolume(whole));
}

TEST(SolidRelease, ScaleAndPlaceDoNotMatter) {
  const Mesh mesh = shapes::joined(shapes::torus(60, 30), shapes::icosphere(3, 0.5, {1, 0.1, 0.2}));
  const Solid solid(mesh);
  ASSERT_TRUE(solid.overlaps());
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (const double far : {0.0, 1000.0}) {
      SCOPED_TRACE(::testing::Message() << "scale " << scale << " far " << far);
      const Vec3 shift = scale * far * solid.diagonal() * Vec3{0.6, -0.64, 0.48};
      const Solid moved(shapes::transformed(mesh, scale, shift));
      EXPECT_NEAR(moved.volume() / std::pow(scale, 3), solid.volume(), 1e-5 * solid.volume());
      EXPECT_NEAR(moved.area() / (scale * scale), solid.area(), 1e-6 * solid.area());
      const CounterRandom random(12, 1);
      for (int i = 0; i < 200; ++i) {
        const Vec3 p = 1.5 * randomPoint(random, i);
        EXPECT_NEAR(moved.signedDistance(shift + scale * p) / scale, solid.signedDistance(p), 1e-6);
      }
    }
  }
}

TEST(Solid, NoInsideIsAnError) {
  Mesh flat;
  flat.name = "flat.obj";
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  flat.triangles = {{0, 1, 2}};
  EXPECT_THROW(Solid{flat}, DataError);
  EXPECT_THROW(Solid{Mesh{}}, DataError);
}

TEST(Solid, SettingsAndCancelling) {
  const Mesh mesh = shapes::icosphere(2);
  SolidSettings settings;
  for (const double size : {0.0, -1.0, 1.0, std::nan("")}) {
    settings.pieceSize = size;
    EXPECT_THROW(Solid(mesh, settings), SettingError);
  }
  settings = {};
  test::expectCancels([&] { Solid(mesh, settings); });
}

TEST(Solid, ManyCrossingTrianglesStayBounded) {
  // Closed tetrahedra at random, all through each other.
  const CounterRandom random(5, 5);
  Mesh mesh;
  for (int t = 0; t < 30; ++t) {
    const int v = static_cast<int>(mesh.vertices.size());
    for (int k = 0; k < 4; ++k) mesh.vertices.push_back(randomPoint(random, 4 * t + k));
    mesh.triangles.insert(
        mesh.triangles.end(),
        {{v, v + 1, v + 2}, {v, v + 2, v + 3}, {v, v + 3, v + 1}, {v + 1, v + 3, v + 2}});
  }
  const Solid solid(mesh, {.pieceSize = 1.0 / 100});
  EXPECT_TRUE(solid.overlaps());
  EXPECT_LT(solid.surface().triangles.size(), 1'500'000u);
  // Volume of the union by counting.
  int inside = 0;
  for (int i = 0; i < 20000; ++i) inside += solid.inside(randomPoint(random, 1000 + i));
  EXPECT_NEAR(solid.volume(), 8.0 * inside / 20000, 0.12);
}

// A ball whose cap beyond x = 0.5 is drawn through itself, so that its winding number there is -1.
TEST(Solid, TellsWhatIsInsideOut) {
  EXPECT_EQ(Solid(shapes::icosphere(3)).insideOut(), 0);
  Mesh mesh = shapes::icosphere(4);
  for (Vec3& v : mesh.vertices) v.y *= 0.5 - v.x;
  double all = 0, turned = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& corners = mesh.triangles[t];
    const double area = norm(areaVector(mesh, static_cast<int>(t)));
    all += area;
    if (mesh.vertices[corners[0]].x + mesh.vertices[corners[1]].x + mesh.vertices[corners[2]].x >
        1.5)
      turned += area;
  }
  const Solid solid(mesh);
  EXPECT_NEAR(solid.insideOut(), turned / all, 0.01);  // triangles across x = 0.5, narrow there
  EXPECT_GT(solid.insideOut(), 0.05);
  EXPECT_FALSE(solid.inside({0.75, 0, 0}));
  EXPECT_TRUE(solid.inside({0, 0, 0}));
}

}  // namespace
}  // namespace innermap
