#include "texture/detail/texture_grids.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/expect.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

using openvdb::Coord;
using openvdb::Vec3f;
using openvdb::Vec3fGrid;

template <class Value>
Vec3fGrid::Ptr block(const Value& value, int n = 12) {
  openvdb::initialize();
  auto grid = Vec3fGrid::create();
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.1));
  auto to = grid->getAccessor();
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < n; ++z) to.setValue({x, y, z}, value(x, y, z));
  return grid;
}

double lengthOf(const Vec2& v) { return std::hypot(v.x, v.y); }

TEST(TextureGrids, EachVoxelSeesItsOwnCoordinatesAndWhatItCovers) {
  // u grows by 0.02 a voxel along x, v by 0.01 along y.
  const auto uv = block([](int x, int y, int) {
    return Vec3f(0.02f * static_cast<float>(x), 0.01f * static_cast<float>(y), 0);
  });
  const TextureLookup texture = [](const Vec2& at, const Vec2& a, const Vec2& b) {
    EXPECT_NEAR(std::max(lengthOf(a), lengthOf(b)), 0.02, 1e-6);
    EXPECT_NEAR(std::min(lengthOf(a), lengthOf(b)), 0.01, 1e-6);
    EXPECT_NEAR(a.x * b.x + a.y * b.y, 0, 1e-9);
    return Vec3{at.x, at.y, 0.5};
  };
  const auto colour = lookUpColours(*uv, texture);
  EXPECT_EQ(colour->getName(), "Cd");
  EXPECT_EQ(colour->activeVoxelCount(), uv->activeVoxelCount());
  EXPECT_EQ(colour->transform(), uv->transform());
  for (auto it = colour->cbeginValueOn(); it; ++it) {
    EXPECT_NEAR((*it)[0], 0.02 * it.getCoord().x(), 1e-6);
    EXPECT_NEAR((*it)[1], 0.01 * it.getCoord().y(), 1e-6);
    EXPECT_NEAR((*it)[2], 0.5, 1e-6);
  }
}

TEST(TextureGrids, AJumpOnOneSideDoesNotWiden) {
  const auto uv = block([](int x, int, int) {
    return Vec3f((x < 6 ? 0.0f : 0.7f) + 0.01f * static_cast<float>(x), 0, 0);
  });
  lookUpColours(*uv, [](const Vec2&, const Vec2& a, const Vec2& b) {
    EXPECT_LT(std::max(lengthOf(a), lengthOf(b)), 0.0101);
    return Vec3{};
  });
}

// Two groups: weights change over along x, coordinates are constants.
std::vector<ChartGroupGrid> twoGroups() {
  const auto weight = [](int x) {
    return std::clamp((static_cast<float>(x) - 3) / 6, -0.05f, 1.05f);
  };
  const auto first = block([&](int x, int, int) {
    const float w = 1 - weight(x);
    return Vec3f(w, 0.1f * w, 0.2f * w);
  });
  const auto second = block([&](int x, int, int) {
    const float w = weight(x);
    return Vec3f(w, -0.25f * w, 0);
  });
  return {{first, {0, 0}}, {second, {1, 0.5}}};
}

TEST(TextureGrids, BlendsByWeightAndIgnoresNoise) {
  // Red in the first group, blue in the second.
  const TextureLookup texture = [](const Vec2& uv, const Vec2&, const Vec2&) {
    if (uv.x < 0.5) {
      EXPECT_NEAR(uv.x, 0.1, 1e-5);
      EXPECT_NEAR(uv.y, 0.2, 1e-5);
      return Vec3{1, 0, 0};
    }
    EXPECT_NEAR(uv.x, 0.75, 1e-5);
    EXPECT_NEAR(uv.y, 0.5, 1e-5);
    return Vec3{0, 0, 1};
  };
  const BlendedTexture out = blendChartGroups(twoGroups(), texture);
  EXPECT_EQ(out.colour->getName(), "Cd");
  EXPECT_EQ(out.uv->getName(), "uv");
  const auto colour = [&](int x) { return out.colour->tree().getValue({x, 5, 5}); };
  for (int x = 0; x < 12; ++x) {
    EXPECT_NEAR(colour(x)[0] + colour(x)[2], 1, 1e-6);
    EXPECT_NEAR(colour(x)[1], 0, 1e-9);
    const double w = std::clamp((x - 3) / 6.0, 0.0, 1.0);
    EXPECT_NEAR(colour(x)[2], w, 0.03);
    if (w < 0.01) {
      EXPECT_EQ(colour(x)[2], 0);
    }
    if (x != 6) {
      EXPECT_NEAR(out.uv->tree().getValue({x, 5, 5})[0], w > 0.5 ? 0.75 : 0.1, 1e-5);
    }
  }
}

TEST(TextureGrids, BadGroups) {
  const TextureLookup texture = [](const Vec2&, const Vec2&, const Vec2&) { return Vec3{}; };
  EXPECT_THROW(blendChartGroups({}, texture), DataError);
  auto groups = twoGroups();
  groups[1].weighted = block([](int, int, int) { return Vec3f(1); }, 5);
  EXPECT_THROW(blendChartGroups(groups, texture), DataError);
  test::expectCancels([&] { blendChartGroups(twoGroups(), texture); });
  test::expectCancels([&] { lookUpColours(*twoGroups()[0].weighted, texture); });
}

}  // namespace
}  // namespace innermap
