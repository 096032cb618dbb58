#include "fit/detail/bent_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mesh/shapes.h"

namespace innermap {
namespace {

using Image = Vec3 (*)(const Vec3&);

// A surface's image by a map, as steps carry it, and places on it.
class BentImage {
 public:
  explicit BentImage(Image image) : source(shapes::icosphere(2)), solid(moved(image)) {
    for (const Triangle& t : source.triangles)
      for (int e = 0; e < 3; ++e) {
        const int a = std::min(t[e], t[(e + 1) % 3]), b = std::max(t[e], t[(e + 1) % 3]);
        const Vec3 from = source.vertices[a], way = source.vertices[b] - from;
        for (std::size_t k = 0; k < 3; ++k) edges[{a, b}][k] = image(from + kAlongEdge[k] * way);
      }
  }

  Mesh source;
  Solid solid;
  EdgeImages edges;

 private:
  Solid moved(Image image) const {
    Mesh mesh = source;
    for (Vec3& p : mesh.vertices) p = image(p);
    return Solid(mesh);
  }
};

Vec3 quadratic(const Vec3& p) {
  return {p.x + 0.1 * p.y * p.z, p.y - 0.08 * (p.x * p.x - p.z * p.z), 1.1 * p.z};
}

Vec3 quartic(const Vec3& p) { return {p.x + 0.1 * p.y * p.y * p.z * p.z, p.y, p.z}; }

const std::array<std::array<double, 3>, 5> kPlaces{
    {{1, 0, 0}, {0, 0.3, 0.7}, {0.45, 0.55, 0}, {0.2, 0.3, 0.5}, {1. / 3, 1. / 3, 1. / 3}}};

TEST(BentMesh, IsExactForQuadraticImages) {
  const BentImage image(quadratic);
  const BentMesh bent(image.solid, image.edges);
  double most = 0;
  for (int t = 0; t < static_cast<int>(image.source.triangles.size()); t += 7)
    for (const auto& b : kPlaces) {
      const BentMesh::Place place = bent.at({t, b});
      EXPECT_LT(norm(place.position - quadratic(positionOf(image.source, {t, b}))), 1e-14);
      most = std::max(most, place.bent);
    }
  // An eighth of the squared edge, at most 0.34 here, times second derivatives of 0.16 and 0.1.
  EXPECT_LT(most, 0.34 * 0.34 / 8 * 0.26);
  EXPECT_GT(most, 1e-4);
}

TEST(BentMesh, IsExactAlongEdgesForQuarticOnes) {
  const BentImage image(quartic);
  const BentMesh bent(image.solid, image.edges);
  double inside = 0;
  for (int t = 0; t < static_cast<int>(image.source.triangles.size()); t += 7)
    for (const auto& b : kPlaces) {
      const double off = norm(bent.at({t, b}).position - quartic(positionOf(image.source, {t, b})));
      if (b[0] * b[1] * b[2] > 0)
        inside = std::max(inside, off);
      else
        EXPECT_LT(off, 1e-14);
    }
  EXPECT_GT(inside, 1e-8);
}

TEST(BentMesh, SaysWhereEdgesAreNotKnown) {
  BentImage image(quadratic);
  const Triangle& t = image.source.triangles[3];
  image.edges.erase({std::min(t[1], t[2]), std::max(t[1], t[2])});
  const BentMesh bent(image.solid, image.edges);
  EXPECT_TRUE(std::isinf(bent.at({3, {0.2, 0.3, 0.5}}).bent));
}

}  // namespace
}  // namespace innermap
