#include <gtest/gtest.h>

#include "innermap/surface/correspond.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

Layout ownPlaces(const Mesh& sphere) {
  Layout layout;
  for (const Vec3& p : sphere.vertices) layout.place.push_back(p / norm(p));
  return layout;
}

TEST(Layout, ASphereOnItselfCoversItOnce) {
  const Mesh sphere = shapes::icosphere(3);
  const LayoutQuality q = layoutQuality(sphere.triangles, sphere.vertices, ownPlaces(sphere));
  EXPECT_EQ(q.flips, 0u);
  EXPECT_NEAR(q.degree, 1, 1e-12);
  EXPECT_NEAR(q.areaRatioLog10, 0, 0.02);
}

TEST(Layout, FlipsAndFoldsAreSeen) {
  const Mesh sphere = shapes::icosphere(2);
  Layout layout = ownPlaces(sphere);
  for (Vec3& p : layout.place) p = -p;  // inside out: all are flipped
  LayoutQuality q = layoutQuality(sphere.triangles, sphere.vertices, layout);
  EXPECT_EQ(q.flips, sphere.triangles.size());
  EXPECT_NEAR(q.degree, -1, 1e-12);
  layout = ownPlaces(sphere);
  const Triangle t = sphere.triangles[0];
  // A vertex pulled over the opposite edge flips its triangle; the degree does not show that.
  const Vec3 over = layout.place[t[1]] + layout.place[t[2]] - 0.9 * layout.place[t[0]];
  layout.place[t[0]] = over / norm(over);
  q = layoutQuality(sphere.triangles, sphere.vertices, layout);
  EXPECT_GE(q.flips, 1u);
  EXPECT_NEAR(q.degree, 1, 1e-12);
}

TEST(Layout, TheTorusHasCopies) {
  // One square of the lattice, two triangles, one vertex.
  Layout layout;
  layout.space = ModelSpace::torus;
  layout.place = {{0.2, 0.3, 1}};
  layout.period = {Vec3{2, 0, 0}, Vec3{1, 3, 0}};
  layout.shift = {{Shift{0, 0}, Shift{1, 0}, Shift{1, 1}}, {Shift{0, 0}, Shift{1, 1}, Shift{0, 1}}};
  const std::vector<Triangle> triangles{{0, 0, 0}, {0, 0, 0}};
  const Vec3 far = layout.corner(triangles, 0, 2);
  EXPECT_NEAR(far.x, 3.2, 1e-15);
  EXPECT_NEAR(far.y, 3.3, 1e-15);
  const LayoutQuality q = layoutQuality(triangles, {{0, 0, 0}}, layout);
  EXPECT_EQ(q.flips, 0u);
  EXPECT_NEAR(q.degree, 1, 1e-14);
}

TEST(Layout, TripleProductsOfThinConesKeepTheirSign) {
  // An edge of 1e-9 far from the axes: the plain determinant rounds to noise there.
  const Vec3 p = Vec3{1, 2, 3} / std::sqrt(14.0);
  const Vec3 q = p + Vec3{1e-9, 0, 0}, r = p + Vec3{0, 1e-9, 0};
  EXPECT_GT(tripleProduct(p, q, r), 0);
  EXPECT_LT(tripleProduct(p, r, q), 0);
  EXPECT_NEAR(tripleProduct(p, q, r), 1e-18 * p.z, 1e-24);
}

TEST(LayoutQuality, OfSeveralShellsIsTheWorst) {
  LayoutQuality good, turned, thin;
  good.degree = 1;
  turned.degree = -1;
  turned.flips = 3;
  turned.areaRatioLog10 = -1;
  thin.degree = 1;
  thin.flips = 2;
  thin.areaRatioLog10 = -4;
  const LayoutQuality all = together({good, turned, thin});
  EXPECT_EQ(all.flips, 5u);
  EXPECT_EQ(all.degree, -1);
  EXPECT_EQ(all.areaRatioLog10, -4);
}

}  // namespace
}  // namespace innermap
