#include "evaluate/visit_field.h"

#include <gtest/gtest.h>

#include <atomic>

#include "core/expect.h"
#include "core/random.h"
#include "evaluate/active_region.h"
#include "field/affine_map.h"
#include "innermap/core/error.h"
#include "innermap/levelset/level_set.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

// Two channels: 2 x + 1, and one over the distance from a point outside the ball.
HarmonicField twoChannels() {
  Affine affine{{}, Matrix(4, 2)};
  affine.coefficients(0, 0) = 1;
  affine.coefficients(1, 0) = 2;
  Matrix weights(1, 2);
  weights(0, 1) = 1;
  return HarmonicField({{0, 0, 1.5}}, weights, affine);
}
Vec3 away(const Vec3& p) { return p - Vec3{0, 0, 1.5}; }

struct Scene {
  Solid solid;
  openvdb::FloatGrid::Ptr levelSet;
  openvdb::MaskGrid::Ptr region;

  explicit Scene(const Mesh& mesh = shapes::icosphere(3), int resolution = 24) : solid(mesh) {
    levelSet = makeLevelSet(solid, {.resolution = resolution});
    region = activeRegion(*levelSet);
  }

  FieldRegion where() const { return {solid, *levelSet, *region}; }
};

// A map in two steps: values and gradients are those of its evaluation at points, outside too.
TEST(VisitField, MapsInSteps) {
  const Scene scene;
  Matrix weights(1, 3);
  weights(0, 1) = 0.2;
  const HarmonicMap step(HarmonicField({{0, 0, 1.6}}, weights, test::affineOf(test::kIdentity)));
  const ComposedMap map({step, step});
  std::atomic<std::size_t> visited{0};
  std::vector<double> error(scene.region->tree().leafCount(), 0);
  visitField(map, scene.where(),
             [&](std::size_t leaf, const LeafValues& v) {
               for (std::size_t i = 0; i < v.count; ++i) {
                 const openvdb::Coord ijk =
                     v.origin + openvdb::MaskTree::LeafNodeType::offsetToLocalCoord(v.offset[i]);
                 const openvdb::Vec3d w = scene.levelSet->transform().indexToWorld(ijk);
                 const Vec3 at = Vec3{w.x(), w.y(), w.z()} - v.beyond[i];
                 const Mat3 j = map.jacobian(at);
                 const Vec3 wanted = map(at) + j * v.beyond[i];
                 for (int r = 0; r < 3; ++r) {
                   error[leaf] = std::max(error[leaf], std::abs(v.values[3 * i + r] - wanted[r]));
                   for (int a = 0; a < 3; ++a)
                     error[leaf] = std::max(
                         error[leaf], 1e-2 * std::abs(v.gradients[9 * i + 3 * r + a] - j[r][a]));
                 }
                 ++visited;
               }
             },
             {1e-9, {}});
  EXPECT_EQ(visited, scene.region->activeVoxelCount());
  EXPECT_LT(*std::max_element(error.begin(), error.end()), 1e-7);
}

TEST(VisitField, ValuesInsideAndBeyond) {
  const Scene scene;
  const HarmonicField field = twoChannels();
  std::atomic<std::size_t> visited{0}, outside{0};
  std::vector<double> error(scene.region->tree().leafCount(), 0);
  visitField(field, scene.where(),
             [&](std::size_t leaf, const LeafValues& v) {
               ASSERT_EQ(v.channels, 2u);
               for (std::size_t i = 0; i < v.count; ++i) {
                 const openvdb::Coord ijk =
                     v.origin + openvdb::MaskTree::LeafNodeType::offsetToLocalCoord(v.offset[i]);
                 ASSERT_TRUE(scene.region->tree().isValueOn(ijk));
                 const openvdb::Vec3d w = scene.levelSet->indexToWorld(ijk);
                 const Vec3 p{w.x(), w.y(), w.z()}, c = p - v.beyond[i], d = away(c);
                 const double r = norm(d);
                 const Vec3 gradient = -1 / (r * r * r) * d;
                 double e = std::abs(v.values[2 * i] - (2 * p.x + 1));
                 e = std::max(e,
                              std::abs(v.values[2 * i + 1] - (1 / r + dot(gradient, v.beyond[i]))));
                 for (int a = 0; a < 3; ++a)
                   e = std::max(e, std::abs(v.gradients[6 * i + 3 + a] - gradient[a]));
                 error[leaf] = std::max(error[leaf], e);
                 ASSERT_EQ(v.inside[i] != 0, scene.levelSet->tree().getValue(ijk) < 0);
                 if (!v.inside[i]) {
                   ++outside;
                   ASSERT_NEAR(norm(v.beyond[i]), scene.solid.distance(p), 1e-9);
                 }
               }
               visited += v.count;
             },
             {1e-10, "test"});
  EXPECT_EQ(visited, scene.region->activeVoxelCount());
  EXPECT_GT(outside, 100u);
  for (const double e : error) EXPECT_LT(e, 1e-8);
}

TEST(VisitField, ValuesAlone) {
  const Scene scene;
  std::vector<double> error(scene.region->tree().leafCount(), 0);
  VisitSettings settings{.accuracy = 1e-10, .gradients = false};
  visitField(
      twoChannels(), scene.where(),
      [&](std::size_t leaf, const LeafValues& v) {
        ASSERT_EQ(v.gradients, nullptr);
        for (std::size_t i = 0; i < v.count; ++i) {
          const openvdb::Coord ijk =
              v.origin + openvdb::MaskTree::LeafNodeType::offsetToLocalCoord(v.offset[i]);
          const double x = scene.levelSet->indexToWorld(ijk).x();
          error[leaf] = std::max(error[leaf], std::abs(v.values[2 * i] - (2 * x + 1)));
        }
      },
      settings);
  for (const double e : error) EXPECT_LT(e, 1e-8);
}

// Of a region that is visited by one field after another, places are looked for once. Longer than
// one block of voxels.
TEST(VisitField, KeptPlacesGiveTheSameValues) {
  Mesh needle = shapes::icosphere(3);
  for (Vec3& v : needle.vertices) v = {v.x, 0.1 * v.y, 0.1 * v.z};
  const Scene scene(needle, 150);
  const auto sumsOf = [](const HarmonicField& field, const FieldRegion& where) {
    std::vector<double> sums(where.leafCount(), 0);
    visitField(field, where,
               [&](std::size_t leaf, const LeafValues& v) {
                 for (std::size_t i = 0; i < v.count; ++i)
                   sums[leaf] += (1.0 + v.offset[i]) * (v.share[i] + v.values[2 * i + 1]) +
                                 norm(v.beyond[i]) + v.gradients[6 * i + 5];
               },
               {1e-10, {}});
    return sums;
  };
  FieldRegion kept = scene.where();
  kept.keepPlans();
  Matrix weights(1, 2);
  weights(0, 1) = -3;
  const HarmonicField other({{0, 1.7, 0}}, weights, twoChannels().affine());
  for (const HarmonicField& field : {twoChannels(), other}) {
    const std::vector<double> found = sumsOf(field, kept), wanted = sumsOf(field, scene.where());
    ASSERT_EQ(found.size(), wanted.size());
    for (std::size_t l = 0; l < found.size(); ++l)
      EXPECT_NEAR(found[l], wanted[l], 1e-12 * std::abs(wanted[l])) << l;
  }
}

TEST(VisitField, PointsAgreeWithVoxels) {
  const Scene scene;
  const HarmonicField field = twoChannels();
  const CounterRandom random(11, 0);
  Points points;
  for (std::uint64_t i = 0; i < 500; ++i) points.push_back(shapes::randomPoint(random, i));
  const ExtendedSamples found =
      sampleExtended(field, scene.solid, *scene.levelSet, points, {1e-10, {}});
  std::size_t outside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool inside = scene.solid.inside(points[i]);
    outside += !inside;
    EXPECT_EQ(norm(found.beyond[i]) > 0, !inside) << i;
    const Vec3 c = points[i] - found.beyond[i], d = away(c);
    const double r = norm(d);
    EXPECT_NEAR(found.samples.values(i, 1), 1 / r - dot(d, found.beyond[i]) / (r * r * r), 1e-8);
    EXPECT_NEAR(found.samples.values(i, 0), 2 * points[i].x + 1, 1e-9);
  }
  EXPECT_GT(outside, 50u);
}

TEST(VisitField, RefusesOtherLattices) {
  const Scene scene;
  const auto other = scene.region->deepCopy();
  other->setTransform(openvdb::math::Transform::createLinearTransform(0.3));
  const auto nothing = [](std::size_t, const LeafValues&) {};
  EXPECT_THROW(FieldRegion(scene.solid, *scene.levelSet, *other), DataError);
  EXPECT_THROW(visitField(twoChannels(), scene.where(), nothing, {}), SettingError);
  test::expectCancels([&] { visitField(twoChannels(), scene.where(), nothing, {1e-8, {}}); });
}

}  // namespace
}  // namespace innermap
