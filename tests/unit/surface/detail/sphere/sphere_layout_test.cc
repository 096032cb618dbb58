#include "surface/detail/sphere/sphere_layout.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/mesh/mesh_file.h"
#include "innermap/surface/correspond.h"
#include "mesh/shapes.h"
#include "surface/handle_shapes.h"

namespace innermap {
namespace {

void expectOneToOne(const ClosedSurface& surface, double leastLog10, const std::string& what) {
  SCOPED_TRACE(what);
  const Layout layout = layOutSphere(surface);
  ASSERT_EQ(layout.place.size(), surface.vertices.size());
  const LayoutQuality q = layoutQuality(surface.triangles, surface.vertices, layout);
  EXPECT_EQ(q.flips, 0u);
  EXPECT_NEAR(q.degree, 1, 1e-9);
  EXPECT_GT(q.areaRatioLog10, leastLog10);
  for (const Vec3& p : layout.place) ASSERT_NEAR(norm(p), 1, 1e-14);
}

ClosedSurface stretched(ClosedSurface surface, double factor) {
  for (Vec3& p : surface.vertices) p.x *= factor;
  return surface;
}

// A ball with a long thin spike, which conformal maps shrink to nothing.
ClosedSurface spiked() {
  ClosedSurface out = shapes::closed(shapes::icosphere(3), 0);
  for (Vec3& p : out.vertices)
    if (p.z > 0.9) p.z = 0.9 + 120 * (p.z - 0.9);
  return out;
}

TEST(SphereLayout, SimpleBodies) {
  const ClosedSurface ball = shapes::closed(shapes::icosphere(3), 0);
  expectOneToOne(ball, -0.3, "ball");
  expectOneToOne(stretched(ball, 100), -4, "stick 100 to 1");
  expectOneToOne(stretched(ball, 0.01), -2, "plate 100 to 1");
  expectOneToOne(spiked(), -2, "spike");
  expectOneToOne(shapes::closed(shapes::icosphere(0), 0), -0.5, "icosahedron");
}

TEST(SphereLayout, NoiseAndDegenerateVertices) {
  const ClosedSurface ball = shapes::closed(shapes::icosphere(3), 0);
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    expectOneToOne(shapes::shaken(ball, 0.08, seed), -2, "noise, seed " + std::to_string(seed));
    expectOneToOne(shapes::degenerated(ball, 0.05, seed), -2,
                   "degenerate, seed " + std::to_string(seed));
  }
  ClosedSurface tiny = ball;
  for (Vec3& p : tiny.vertices) p = 1e-9 * p + Vec3{1, 2, 3};
  expectOneToOne(tiny, -1, "1e-9 of its distance from the origin");
}

TEST(SphereLayout, AFanOfManyTriangles) {
  // Two hubs of valence 400.
  ClosedSurface out;
  const int n = 400;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * kPi * i / n;
    out.vertices.push_back({std::cos(a), std::sin(a), 0});
  }
  out.vertices.push_back({0, 0, 1});
  out.vertices.push_back({0, 0, -1});
  for (int i = 0; i < n; ++i) {
    out.triangles.push_back({i, (i + 1) % n, n});
    out.triangles.push_back({(i + 1) % n, i, n + 1});
  }
  expectOneToOne(out, -2, "double cone");
}

TEST(SphereLayout, OtherTopologyIsRefused) {
  ClosedSurface torus = shapes::tube(shapes::circle, 24, 12, 0.4);
  EXPECT_THROW(layOutSphere(torus), DataError);
}

TEST(SphereLayout, Cancels) {
  test::expectCancels([&] { layOutSphere(shapes::closed(shapes::icosphere(3), 0)); });
}

TEST(SphereLayoutRelease, RealMeshes) {
  const std::string models = INNERMAP_MODELS;
  if (!std::filesystem::exists(models)) GTEST_SKIP() << "no ../shared/models";
  for (const char* name :
       {"spot.obj", "homer.obj", "cheburashka.obj", "fandisk.obj", "horse-poses/reference.obj"}) {
    const SurfaceShells shells =
        closedSurfaces(readMesh(models + "/" + name), {.closeHoles = true});
    ASSERT_EQ(shells.shells.size(), 1u) << name;
    const ClosedSurface& surface = shells.shells[0];
    expectOneToOne(surface, -2, name);
    expectOneToOne(shapes::degenerated(surface, 0.02), -2, std::string(name) + ", degenerate");
    const double edge = boundingBox(surface.vertices).diagonal() /
                        std::sqrt(static_cast<double>(surface.vertices.size()));
    expectOneToOne(shapes::shaken(surface, 0.2 * edge), -2.5, std::string(name) + ", noise");
    expectOneToOne(stretched(surface, 100), -8, std::string(name) + ", stick");
  }
}

}  // namespace
}  // namespace innermap
