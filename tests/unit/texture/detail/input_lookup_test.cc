#include "texture/detail/input_lookup.h"

#include <gtest/gtest.h>

#include "innermap/core/error.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

Vec3 placeOf(const Mesh& mesh, const InputPoint& p) {
  const Triangle& t = mesh.triangles[static_cast<std::size_t>(p.triangle)];
  return p.mean([&](int k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; });
}

std::vector<SurfacePoint> somePoints(const Mesh& mesh) {
  const CounterRandom random(7, 1);
  std::vector<SurfacePoint> points;
  for (std::uint64_t i = 0; i < 500; ++i) {
    const double a = random.uniform(3 * i), b = (1 - a) * random.uniform(3 * i + 1);
    const auto t =
        static_cast<int>(random.uniform(3 * i + 2) * static_cast<double>(mesh.triangles.size()));
    points.push_back({t, {a, b, 1 - a - b}});
  }
  return points;
}

// Points of the surface lead back to the same places of the input, whatever repair did to it.
TEST(InputLookup, LeadsToTheSamePlace) {
  Mesh turned = shapes::icosphere(2);
  for (std::size_t t = 0; t < turned.triangles.size(); t += 3)
    std::swap(turned.triangles[t][1], turned.triangles[t][2]);
  const Mesh overlapping = shapes::joined(
      shapes::icosphere(2), shapes::transformed(shapes::icosphere(2), 1, {0.7, 0.1, 0}));
  for (const Mesh& mesh : {turned, overlapping}) {
    const Solid solid(mesh);
    const InputLookup lookup(solid, mesh, std::vector<char>(mesh.triangles.size(), 1), "a value");
    EXPECT_NEAR(lookup.bearingShare(), 1, 1e-12);
    for (const SurfacePoint& s : somePoints(solid.surface()))
      EXPECT_LT(norm(placeOf(mesh, lookup.at(s)) - positionOf(solid.surface(), s)), 1e-9);
  }
}

TEST(InputLookup, CapsAndBareTrianglesTakeTheNearestThatBears) {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.triangles.resize(10);  // one side open: repair caps it
  std::vector<char> bears(10, 1);
  bears[0] = bears[1] = 0;  // the side z = 0
  const Solid solid(mesh);
  const InputLookup lookup(solid, mesh, bears, "a value");
  EXPECT_NEAR(lookup.bearingShare(), 4.0 / 6, 1e-9);
  for (const SurfacePoint& s : somePoints(solid.surface())) {
    const Vec3 here = positionOf(solid.surface(), s);
    const InputPoint found = lookup.at(s);
    ASSERT_TRUE(bears[static_cast<std::size_t>(found.triangle)]);
    const double away = norm(placeOf(mesh, found) - here);
    const int parent = solid.repaired().parent[static_cast<std::size_t>(solid.address(s).triangle)];
    if (parent >= 0 && bears[static_cast<std::size_t>(parent)]) {
      EXPECT_LT(away, 1e-9);
    } else {
      EXPECT_LE(away, 0.5 + 1e-9);  // no farther than the middle of a side from its edges
    }
  }
}

TEST(InputLookup, BadArguments) {
  const Mesh mesh = shapes::icosphere(1);
  const Solid solid(mesh);
  EXPECT_THROW(InputLookup(solid, mesh, std::vector<char>(3, 1), "a value"), DataError);
  EXPECT_THROW(InputLookup(solid, mesh, std::vector<char>(mesh.triangles.size(), 0), "a value"),
               DataError);
  const Mesh other = shapes::icosphere(0);
  EXPECT_THROW(InputLookup(solid, other, std::vector<char>(20, 1), "a value"), DataError);
}

}  // namespace
}  // namespace innermap
