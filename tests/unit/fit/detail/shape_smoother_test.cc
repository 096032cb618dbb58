#include "fit/detail/shape_smoother.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "fit/detail/shape_path.h"
#include "fit/test_pairs.h"
#include "innermap/mesh/check.h"

namespace innermap {
namespace {

double farthest(const Points& a, const Points& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, norm(a[i] - b[i]));
  return most;
}

std::size_t crossings(const ShapePath& path, const Mesh& mesh) {
  std::size_t count = 0;
  for (const double t : {0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875})
    count += selfIntersections(path.at(t), mesh.triangles).size();
  return count;
}

// Half way a limb that is turned inside out is a flat disc, wider than the body: so it runs through
// the body, unless it has shrunk before, and through itself where its end is wide and has no room.
TEST(ShapeSmoother, LimbsTurnIntoPitsWithoutCrossings) {
  const Limb stub{0.3, 0}, thin{0.2, 0}, headed{0.2, 0.8}, mushroom{0.2, 1.5};
  for (const Limb& limb : {stub, thin, headed, mushroom})
    for (const double pit : {-1.0, -1.6}) {
      SCOPED_TRACE(::testing::Message()
                   << "a pit of " << pit << ", " << limb.width << " wide, its head " << limb.head);
      const Mesh from = drawnOut(1.5, limb), to = drawnOut(pit, limb);
      const auto path = [&](Between between) {
        return ShapePath(from.vertices, to.vertices, from.triangles, 1, between);
      };
      EXPECT_GT(crossings(path(Between::interpolated), from), 0);
      EXPECT_EQ(crossings(path(Between::smoothed), from), 0);
    }
}

TEST(ShapeSmoother, BeginsAndEndsWithTheShapes) {
  const Mesh from = drawnOut(1.5), to = drawnOut(-1);
  const double growth = std::cbrt(signedVolume(to) / signedVolume(from));
  const ShapePath path(from.vertices, to.vertices, from.triangles, growth, Between::smoothed);
  EXPECT_LT(farthest(path.at(1e-6), from.vertices), 1e-4);
  EXPECT_LT(farthest(path.at(1 - 1e-6), path.at(1)), 1e-4);
}

TEST(ShapeSmoother, KeepsTheVolume) {
  const Mesh from = drawnOut(1.5), to = drawnOut(-1);
  const ShapeSmoother smoother(from.vertices, to.vertices, from.triangles);
  const Points shape = smoother.smoothed(from.vertices, 0.5);
  EXPECT_GT(farthest(shape, from.vertices), 0.25);
  EXPECT_NEAR(signedVolume(shape, from.triangles), signedVolume(from), 1e-9);
}

// Least and most distance from the middle of its volume.
std::pair<double, double> distances(const Points& points, const std::vector<Triangle>& triangles) {
  Vec3 middle;
  double volume = 0;
  for (const Triangle& t : triangles) {
    const Vec3 a = points[t[0]], b = points[t[1]], c = points[t[2]];
    const double cone = dot(a, cross(b, c));
    volume += cone;
    middle = middle + cone * (a + b + c) / 4;
  }
  middle = middle / volume;
  std::pair<double, double> out{std::numeric_limits<double>::infinity(), 0};
  for (const Vec3& p : points) {
    out.first = std::min(out.first, norm(p - middle));
    out.second = std::max(out.second, norm(p - middle));
  }
  return out;
}

// Columns that are spherical harmonics of degree 1, 2 and 3: the flow damps each by its own factor,
// and the volume scales all three alike.
TEST(ShapeSmoother, DampsSphericalHarmonicsByDegree) {
  const Mesh ball = shapes::icosphere(3);
  const ShapeSmoother smoother(ball.vertices, ball.vertices, ball.triangles);
  Points harmonics;
  for (const Vec3& p : ball.vertices)
    harmonics.push_back({p.x, p.x * p.y, p.z * (5 * p.z * p.z - 3 * dot(p, p))});
  const Points damped = smoother.smoothed(harmonics, 0.5);
  const auto kept = [&](double Vec3::*column) {
    double before = 0, after = 0;
    for (std::size_t v = 0; v < harmonics.size(); ++v) {
      before += std::pow(harmonics[v].*column, 2);
      after += std::pow(damped[v].*column, 2);
    }
    return std::sqrt(after / before);
  };
  // Four implicit steps of tau / 4 each, tau = 0.01, on a sphere of area 1: r^2 = 1 / (4 pi).
  const auto expected = [](int degree) {
    return std::pow(1 + 0.01 / 4 * degree * (degree + 1) * 4 * std::acos(-1.0), -4);
  };
  EXPECT_NEAR(kept(&Vec3::y) / kept(&Vec3::x), expected(2) / expected(1), 0.02);
  EXPECT_NEAR(kept(&Vec3::z) / kept(&Vec3::x), expected(3) / expected(1), 0.02);
}

TEST(ShapeSmoother, ASurfaceWithAHandleKeepsIt) {
  const Mesh torus = shapes::torus(48, 24);
  const ShapeSmoother smoother(torus.vertices, torus.vertices, torus.triangles);
  const Points half = smoother.smoothed(torus.vertices, 0.5);
  const auto [least, most] = distances(half, torus.triangles);
  EXPECT_GT(most, 1.2 * least);
  EXPECT_NEAR(signedVolume(half, torus.triangles), signedVolume(torus), 1e-9);
}

// One in no triangle stays, one whose triangles have no area goes with its neighbours.
TEST(ShapeSmoother, VerticesOfNoArea) {
  Mesh from = drawnOut(1);
  const int count = static_cast<int>(from.vertices.size());
  const int a = from.triangles.front()[0], b = from.triangles.front()[1];
  from.vertices.push_back({3, 4, 5});
  from.vertices.push_back(from.vertices[static_cast<std::size_t>(a)]);
  from.triangles.push_back({a, b, count + 1});
  from.triangles.push_back({b, a, count + 1});
  const ShapeSmoother smoother(from.vertices, from.vertices, from.triangles);
  const Points shape = smoother.smoothed(from.vertices, 0.5);
  const double edge = norm(shape[static_cast<std::size_t>(b)] - shape[static_cast<std::size_t>(a)]);
  EXPECT_LT(norm(shape.back() - shape[static_cast<std::size_t>(a)]), 2 * edge);
  const Points near = smoother.smoothed(from.vertices, 1e-9);
  EXPECT_LT(norm(near[static_cast<std::size_t>(count)] - Vec3{3, 4, 5}), 1e-6);
}

}  // namespace
}  // namespace innermap
