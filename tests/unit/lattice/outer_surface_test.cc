#include "innermap/lattice/outer_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>

#include "core/expect.h"
#include "core/pi.h"
#include "core/random.h"
#include "innermap/core/error.h"
#include "innermap/mesh/check.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

OuterSurface outer(const Mesh& mesh, int resolution, std::optional<int> handles = {}) {
  return outerSurface(Solid(mesh), {.resolution = resolution, .handles = handles});
}

void expectEmbedded(const Mesh& mesh) {
  EXPECT_TRUE(boundaryTopology(mesh.vertices, mesh.triangles).manifold());
  std::size_t crossings = 0;
  forEachSelfIntersection(mesh.vertices, mesh.triangles, [&](const Crossing&) { ++crossings; });
  EXPECT_EQ(crossings, 0u);
}

TEST(OuterSurface, UnitesPartsThatOverlap) {
  const Mesh two =
      shapes::joined(shapes::icosphere(3, 1, {-0.6, 0, 0}), shapes::icosphere(3, 1, {0.6, 0, 0}));
  const OuterSurface made = outer(two, 40);
  EXPECT_EQ(made.topology, (SolidTopology{1, 0, 0}));
  EXPECT_TRUE(made.cuts.empty());
  expectEmbedded(made.mesh);
  // Two unit balls less their lens, each cap of height 0.4.
  const double lens = 2 * kPi * 0.4 * 0.4 * (3 - 0.4) / 3;
  EXPECT_NEAR(signedVolume(made.mesh), 8 * kPi / 3 - lens, 0.02 * 8 * kPi / 3);
  EXPECT_LT(made.apartMax, 0.02);
}

// Its ends run into one another: a ring as a union, a ball as a mesh.
void expectCoilCut(std::initializer_list<int> resolutions) {
  const Mesh coil = shapes::coil(2.2 * kPi);
  for (const int resolution : resolutions) {
    SCOPED_TRACE("resolution " + std::to_string(resolution));
    const OuterSurface ball = outer(coil, resolution, 0), ring = outer(coil, resolution);
    EXPECT_EQ(ball.topology, (SolidTopology{1, 0, 0}));
    EXPECT_EQ(ring.topology, (SolidTopology{1, 0, 1})) << "the union's, at all resolutions";
    EXPECT_TRUE(ring.cuts.empty());
    expectEmbedded(ball.mesh);
    expectEmbedded(ring.mesh);
    // Where the ends overlap, half a turn away from the middle of the coil, and nowhere else.
    ASSERT_FALSE(ball.cuts.empty());
    for (const TopologyChange& cut : ball.cuts) EXPECT_GT(cut.place.y, 0);
  }
}

TEST(OuterSurfaceRelease, CutsWhereAMeshMeetsItself) { expectCoilCut({32, 48}); }

TEST(OuterSurfaceNightly, CutsWhereAMeshMeetsItself) { expectCoilCut({40, 64, 80}); }

TEST(OuterSurface, SizeAndPlaceDoNotMatter) {
  for (const double scale : {1e-8, 1e6}) {
    const OuterSurface made = outer(shapes::transformed(shapes::coil(2.2 * kPi), scale, {}), 32, 0);
    EXPECT_EQ(made.topology, (SolidTopology{1, 0, 0}));
    EXPECT_EQ(made.cuts.size(), 1u);
    EXPECT_GT(made.cuts[0].place.y, scale);
    expectEmbedded(made.mesh);
  }
}

// Two plates a cell or two thick, joined along one side, as the rim of an ear over its shell. The
// gap between them is narrower than a cell: opened without care, it takes holes with it out of the
// plates.
TEST(OuterSurfaceRelease, NarrowGapsPierceNoThinWalls) {
  for (const int seed : {1, 3, 6}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Mesh upper = shapes::box({0, 0, 0}, {0.7, 1, 0.05});
    for (Vec3& v : upper.vertices) v.z += 0.055 + 0.03 * v.x;
    Mesh mesh = shapes::joined(shapes::box({-0.2, 0, 0}, {1, 1, 0.05}), upper);
    mesh = shapes::joined(mesh, shapes::box({-0.2, 0, 0.03}, {0.02, 1, 0.3}));
    const Vec3 axis = shapes::randomPoint(CounterRandom(seed, 5), 1);
    const Vec3 x = axis / norm(axis), helper = cross(x, {0.31, 0.62, 0.53});
    const Vec3 y = helper / norm(helper), z = cross(x, y);
    for (Vec3& v : mesh.vertices) v = v.x * x + v.y * y + v.z * z;
    const OuterSurface made = outer(mesh, 40, 0);
    EXPECT_EQ(made.topology, (SolidTopology{1, 0, 0}));
    EXPECT_TRUE(made.cuts.empty());
    EXPECT_TRUE(made.plugs.empty()) << "a hole that was closed again";
    EXPECT_LT(made.apartP99 * Solid(mesh).diagonal(), 0.8 * made.edge) << "rims are rounded";
  }
}

// A ball whose skin is drawn in about one pole until it comes out at the other: there it is inside
// out, and the solid has a tunnel.
Mesh dentedThrough(double width) {
  Mesh mesh = shapes::icosphere(5);
  for (Vec3& v : mesh.vertices) {
    if (v.z < 0) continue;
    const double near = (v.x * v.x + v.y * v.y) / (width * width);
    v.z -= 2.6 * std::exp(-near);
  }
  return mesh;
}

void expectTunnelClosed(int resolution) {
  const OuterSurface closed = outer(dentedThrough(0.3), resolution, 0);
  EXPECT_EQ(closed.topology, (SolidTopology{1, 0, 0}));
  EXPECT_TRUE(closed.cuts.empty());
  ASSERT_EQ(closed.plugs.size(), 1u);
  EXPECT_LT(closed.plugs[0].place.z, -0.5) << "where the tunnel is narrowest";
  expectEmbedded(closed.mesh);
  EXPECT_LT(closed.apartP99 * std::sqrt(12.0), 2.5 * closed.edge);
  const OuterSurface open = outer(dentedThrough(0.3), resolution, 1);
  EXPECT_EQ(open.topology, (SolidTopology{1, 0, 1}));
  EXPECT_TRUE(open.plugs.empty());
}

TEST(OuterSurface, ClosesTunnelsThatItsMeshDoesNotHave) { expectTunnelClosed(32); }

TEST(OuterSurfaceRelease, ClosesThemAtAFinerResolution) { expectTunnelClosed(48); }

TEST(OuterSurfaceRelease, ClosesNoTunnelThatAnotherPartRunsThrough) {
  const Mesh rod = shapes::box({-0.08, -0.08, -1.1}, {0.08, 0.08, 1.5});
  const OuterSurface made = outer(shapes::joined(dentedThrough(0.5), rod), 48, 0);
  EXPECT_EQ(made.topology, (SolidTopology{2, 0, 0}));
  EXPECT_TRUE(made.plugs.empty());
  EXPECT_FALSE(made.cuts.empty());
}

// Of a ring less is cut than its hole would take; of two that overlap no core has one handle alone.
TEST(OuterSurface, ClosesNoHoleOfARing) {
  const Mesh ring = shapes::torus(40, 20);
  const OuterSurface cut = outer(ring, 32, 0);
  EXPECT_TRUE(cut.plugs.empty());
  EXPECT_FALSE(cut.cuts.empty());
  const Mesh two = shapes::joined(ring, shapes::transformed(ring, 1, {2.3, 0, 0}));
  EXPECT_EQ(outer(two, 32).topology.handles, 2);
  EXPECT_THROW(outer(two, 32, 1), DataError);
}

// Two balls meet in a crease of 74 degrees.
TEST(OuterSurfaceRelease, HasNoTeethAlongCreases) {
  const Mesh mesh = outer(shapes::joined(shapes::icosphere(4, 1, {-0.6, 0.05, 0}),
                                         shapes::icosphere(4, 1, {0.6, 0, 0.03})),
                          40)
                        .mesh;
  std::map<std::pair<int, int>, Vec3> normals;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 area = areaVector(mesh, static_cast<int>(t));
    for (int k = 0; k < 3; ++k)
      normals[{mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]}] = area / norm(area);
  }
  double least = 1;
  for (const auto& [edge, normal] : normals)
    least = std::min(least, dot(normal, normals.at({edge.second, edge.first})));
  EXPECT_GT(least, std::cos(kPi / 3));
}

TEST(OuterSurface, LeavesOutOtherPiecesIfOnePieceIsWanted) {
  const Mesh two =
      shapes::joined(shapes::icosphere(3, 1, {-2, 0, 0}), shapes::icosphere(3, 0.5, {2, 0, 0}));
  EXPECT_EQ(outer(two, 40).topology.components, 2);
  const OuterSurface one = outerSurface(Solid(two), {.resolution = 40, .onePiece = true});
  EXPECT_EQ(one.topology.components, 1);
  EXPECT_EQ(one.leftOut, 1u);
  EXPECT_NEAR(one.leftOutShare, 1.0 / 9, 0.02);
}

TEST(OuterSurface, RefusesWhatCannotBe) {
  const Mesh ball = shapes::icosphere(2);
  EXPECT_THROW(outer(ball, 7), SettingError);
  EXPECT_THROW(outer(ball, 40, -1), SettingError);
  EXPECT_THROW(outer(ball, 40, 1), DataError);
  test::expectOverLimit(1000, [&] { outerSurface(Solid(ball), {}); });
  test::expectCancels([&] { outerSurface(Solid(ball), {}); });
}

}  // namespace
}  // namespace innermap
