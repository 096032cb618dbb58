#include "fit/detail/refined_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>

#include "mesh/shapes.h"

namespace innermap {
namespace {

Vec3 bentPoint(const Vec3& p) { return {p.x, p.y, p.z + 0.3 * std::sin(3 * p.x)}; }

struct Refined {
  Mesh mesh;
  RefinedSurface surface;
  Points images;
  EdgeImages edges;
};

Refined refined(double chord, std::size_t most = 1'000'000) {
  Refined out{shapes::icosphere(2), RefinedSurface(shapes::icosphere(2)), {}, {}};
  const auto images = [&](const std::vector<SurfacePoint>& places) {
    Points points = interpolate(out.mesh.vertices, out.mesh.triangles, places);
    for (Vec3& p : points) p = bentPoint(p);
    return points;
  };
  out.images = images(out.surface.vertices);
  refine(out.surface, out.images, out.edges, images, chord, most);
  return out;
}

double areaOf(const Points& vertices, const std::vector<Triangle>& triangles) {
  double sum = 0;
  for (const Triangle& t : triangles)
    sum += norm(cross(vertices[t[1]] - vertices[t[0]], vertices[t[2]] - vertices[t[0]])) / 2;
  return sum;
}

// Bent once more: what is known of the edges goes along and is not asked for again.
TEST(Refine, GoesOnWithWhatIsKnown) {
  const double chord = 2e-3;
  Refined r = refined(chord), fresh = r;
  const auto twice = [&](const std::vector<SurfacePoint>& places) {
    Points points = interpolate(r.mesh.vertices, r.mesh.triangles, places);
    for (Vec3& p : points) p = bentPoint(bentPoint(p));
    return points;
  };
  std::size_t asked[2] = {0, 0};
  for (Refined* one : {&r, &fresh}) {
    for (Vec3& p : one->images) p = bentPoint(p);
    if (one == &r)
      for (auto& edge : one->edges)
        for (Vec3& p : edge.second) p = bentPoint(p);
    else
      one->edges.clear();
    refine(
        one->surface, one->images, one->edges,
        [&](const std::vector<SurfacePoint>& places) {
          asked[one == &r ? 0 : 1] += places.size();
          return twice(places);
        },
        chord, 1'000'000);
  }
  EXPECT_GT(r.surface.triangles.size(), refined(chord).surface.triangles.size());
  EXPECT_EQ(r.surface.triangles, fresh.surface.triangles);
  for (std::size_t v = 0; v < r.images.size(); ++v)
    EXPECT_LT(norm(r.images[v] - fresh.images[v]), 1e-14);
  EXPECT_LT(asked[0], asked[1]);
}

TEST(RefinedSurface, StartsAsTheMesh) {
  const Mesh mesh = shapes::icosphere(1);
  const RefinedSurface surface(mesh);
  EXPECT_EQ(surface.triangles, mesh.triangles);
  const Points at = interpolate(mesh.vertices, mesh.triangles, surface.vertices);
  for (std::size_t v = 0; v < at.size(); ++v) EXPECT_LT(norm(at[v] - mesh.vertices[v]), 1e-15);
}

TEST(Refine, EdgesFollowTheImage) {
  const double chord = 2e-3;
  const Refined r = refined(chord);
  EXPECT_GT(r.surface.triangles.size(), r.mesh.triangles.size());
  EXPECT_EQ(r.images.size(), r.surface.vertices.size());
  for (const Triangle& t : r.surface.triangles)
    for (int e = 0; e < 3; ++e) {
      const int a = t[e], b = t[(e + 1) % 3];
      const Vec3 middle = 0.5 * (r.surface.positions[a] + r.surface.positions[b]);
      EXPECT_LE(norm(bentPoint(middle) - 0.5 * (r.images[a] + r.images[b])), chord);
    }
}

TEST(Refine, CoversTheMeshWithoutGaps) {
  const Refined r = refined(2e-3);
  EXPECT_NEAR(areaOf(r.surface.positions, r.surface.triangles),
              areaOf(r.mesh.vertices, r.mesh.triangles), 1e-12);
  std::map<std::pair<int, int>, int> halfEdges;
  for (const Triangle& t : r.surface.triangles)
    for (int e = 0; e < 3; ++e) ++halfEdges[{t[e], t[(e + 1) % 3]}];
  for (const auto& [edge, count] : halfEdges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(halfEdges.count({edge.second, edge.first}), 1u);
  }
  for (std::size_t t = 0; t < r.surface.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const RefinedSurface::Part& part = r.surface.parts[t];
      const Vec3 at =
          interpolate(r.mesh.vertices, r.mesh.triangles, {{part.triangle, part.corners[k]}})[0];
      EXPECT_LT(norm(at - r.surface.positions[r.surface.triangles[t][k]]), 1e-12);
    }
}

TEST(Refine, LeavesWhatIsStraightAndHeedsTheLimit) {
  EXPECT_EQ(refined(1).surface.triangles.size(), shapes::icosphere(2).triangles.size());
  const std::size_t most = 400;
  EXPECT_LT(refined(1e-5, most).surface.triangles.size(), 4 * most);
}

// No splitting straightens a tear: edges shorter than the chord stay.
TEST(Refine, EndsAtATear) {
  const Mesh mesh = shapes::icosphere(2);
  RefinedSurface surface(mesh);
  const auto images = [&](const std::vector<SurfacePoint>& places) {
    Points points = interpolate(mesh.vertices, mesh.triangles, places);
    for (Vec3& p : points) p.z += p.x > 0.1 ? 1 : 0;
    return points;
  };
  Points at = images(surface.vertices);
  EdgeImages edges;
  refine(surface, at, edges, images, 0.02, 1'000'000);
  EXPECT_LT(surface.triangles.size(), 20000u);
}

}  // namespace
}  // namespace innermap
