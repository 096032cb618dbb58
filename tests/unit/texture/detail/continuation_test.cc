#include "texture/detail/continuation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/expect.h"
#include "core/pi.h"
#include "innermap/core/error.h"
#include "innermap/levelset/level_set.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

// Three or six channels: affine ones, and the potential of a charge well outside.
HarmonicField fieldOf(std::size_t channels) {
  Matrix weights(1, channels), affine(4, channels);
  for (std::size_t k = 0; k < channels; ++k) {
    const double s = static_cast<double>(k) + 1;
    weights(0, k) = 0.3 * s;
    affine(0, k) = s;
    affine(1 + k % 3, k) = 0.5 * s;
  }
  return HarmonicField({{2.5, 0.5, 0}}, weights, {{0, 0, 0}, affine});
}

struct Ball {
  Solid solid{shapes::icosphere(3)};
  openvdb::FloatGrid::Ptr levelSet;
  double voxel = 0;

  explicit Ball(int resolution = 32) {
    openvdb::initialize();
    levelSet = makeLevelSet(solid, {.resolution = resolution});
    voxel = levelSet->voxelSize()[0];
  }
  Vec3 world(const openvdb::Coord& ijk) const {
    const openvdb::Vec3d p = levelSet->indexToWorld(ijk);
    return {p.x(), p.y(), p.z()};
  }
};

Vec3 valueAt(const HarmonicField& field, const Vec3& p, std::size_t g) {
  std::vector<double> v(field.channels());
  field.evaluate(&p, 1, v.data(), nullptr);
  return {v[3 * g], v[3 * g + 1], v[3 * g + 2]};
}

Vec3 toVec3(const openvdb::Vec3f& v) { return {v[0], v[1], v[2]}; }

BoundaryValues boundaryOf(const HarmonicField& field, const Vec3& more = {}) {
  return [&field, more](const Solid::Closest& at, double* out) {
    field.evaluate(&at.position, 1, out, nullptr);
    for (std::size_t k = 0; k < field.channels(); ++k) out[k] += more[static_cast<int>(k % 3)];
  };
}

TEST(Continuation, WhatTheFieldMeetsIsTheFieldInsideAndTheBoundaryOutside) {
  const Ball ball;
  const HarmonicField field = fieldOf(6);
  const auto grids = continueInside(field, ball.solid, *ball.levelSet, boundaryOf(field),
                                    {.spacing = 3 * ball.voxel, .accuracy = 1e-7});
  ASSERT_EQ(grids.size(), 2u);
  EXPECT_TRUE(grids[0]->tree().hasSameTopology(grids[1]->tree()));
  EXPECT_EQ(grids[0]->getVectorType(), openvdb::VEC_INVARIANT);
  std::size_t inside = 0, outside = 0;
  for (std::size_t g = 0; g < 2; ++g)
    for (auto it = grids[g]->cbeginValueOn(); it; ++it) {
      Vec3 p = ball.world(it.getCoord());
      const double distance = ball.levelSet->tree().getValue(it.getCoord());
      EXPECT_LE(distance, 2.001 * ball.voxel);
      (distance < 0 ? inside : outside) += 1;
      if (distance >= 0) p = ball.solid.closest(p, 1).position;
      EXPECT_LT(norm(toVec3(*it) - valueAt(field, p, g)), 1e-5);
    }
  EXPECT_GT(inside, 10000u);
  EXPECT_GT(outside, 4000u);
  // The whole skin is there.
  for (auto it = ball.levelSet->cbeginValueOn(); it; ++it)
    EXPECT_EQ(grids[0]->tree().isValueOn(it.getCoord()), *it <= 2 * ball.voxel);
}

// What the field misses by a constant: all of it at the surface, none in the depth, less and less
// between.
TEST(Continuation, WhatTheFieldMissesFallsOffInwards) {
  const Ball ball(48);
  const HarmonicField field = fieldOf(3);
  const Vec3 missed{1, -2, 0.5};
  const auto grid = continueInside(field, ball.solid, *ball.levelSet, boundaryOf(field, missed),
                                   {.spacing = 3 * ball.voxel, .accuracy = 1e-7})[0];
  for (auto it = grid->cbeginValueOn(); it; ++it) {
    const Vec3 p = ball.world(it.getCoord());
    const double distance = ball.solid.signedDistance(p);
    if (distance >= 0) continue;
    const Vec3 rest = toVec3(*it) - valueAt(field, p, 0);
    const double depth = -distance / ball.voxel;
    if (depth <= 1) {
      EXPECT_LT(norm(rest - missed), 1e-4);
    } else if (depth >= 1 + 1.5 * 3) {
      EXPECT_LT(norm(rest), 1e-5);
    } else {
      EXPECT_NEAR(norm(rest) / norm(missed), std::exp(-kPi * (depth - 1) / 3), 0.01);
    }
  }
}

TEST(Continuation, WithoutASpacingTheFieldIsTakenAlone) {
  const Ball ball;
  const HarmonicField field = fieldOf(3);
  const auto grid =
      continueInside(field, ball.solid, *ball.levelSet, boundaryOf(field, {9, 9, 9}), {})[0];
  for (auto it = grid->cbeginValueOn(); it; ++it) {
    Vec3 p = ball.world(it.getCoord());
    if (ball.levelSet->tree().getValue(it.getCoord()) >= 0) p = ball.solid.closest(p, 1).position;
    EXPECT_LT(norm(toVec3(*it) - valueAt(field, p, 0)), 1e-3);
  }
}

TEST(Continuation, BadSettings) {
  const Ball ball(16);
  const HarmonicField field = fieldOf(3);
  const BoundaryValues boundary = boundaryOf(field);
  EXPECT_THROW(continueInside(field, ball.solid, *ball.levelSet, boundary, {.spacing = -1}),
               SettingError);
  EXPECT_THROW(continueInside(field, ball.solid, *ball.levelSet, boundary, {.skin = 4}),
               SettingError);
  test::expectOverLimit(1000,
                        [&] { continueInside(field, ball.solid, *ball.levelSet, boundary, {}); });
  EXPECT_THROW(continueInside(fieldOf(4), ball.solid, *ball.levelSet, boundary, {}), DataError);
  test::expectCancels([&] { continueInside(field, ball.solid, *ball.levelSet, boundary, {}); });
}

}  // namespace
}  // namespace innermap
