#include "fit/volume_judge.h"

#include <gtest/gtest.h>

#include "innermap/core/error.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

ClosedSurface ball() {
  const Mesh mesh = shapes::icosphere(4);
  return {.name = "ball", .vertices = mesh.vertices, .triangles = mesh.triangles};
}

template <class Map>
double scoreOf(const VolumeJudge& judge, const ClosedSurface& surface, const Map& map) {
  Points images;
  for (const Vec3& p : interpolate(surface.vertices, surface.triangles, judge.at()))
    images.push_back(map(p));
  return judge.score(images);
}

TEST(VolumeJudge, SimilaritiesAreBestAndMirrorsWorst) {
  const ClosedSurface surface = ball();
  const VolumeJudge judge(surface, 4.0 / 3 * 3.14159 * 8);
  const double turned = scoreOf(judge, surface, [](const Vec3& p) {
    return Vec3{5 - 2 * p.y, 2 * p.x, 2 * p.z};
  });
  EXPECT_LT(turned, 1e-4);
  const double mirrored = scoreOf(judge, surface, [](const Vec3& p) {
    return Vec3{2 * p.x, 2 * p.y, -2 * p.z};
  });
  EXPECT_NEAR(mirrored, 20, 0.01);
  // Stretched by 2, 1 and 1 / 2: 2 ln^2 2.
  const double stretched = scoreOf(judge, surface, [](const Vec3& p) {
    return Vec3{4 * p.x, 2 * p.y, p.z};
  });
  EXPECT_NEAR(stretched, 2 * std::pow(std::log(2), 2), 1e-3);
}

// Pulled by a point of the surface through the middle to the other side, it folds.
TEST(VolumeJudge, FoldsCount) {
  const ClosedSurface surface = ball();
  const VolumeJudge judge(surface, 4.0 / 3 * 3.14159);
  const auto pushed = [](double depth) {
    return [depth](const Vec3& p) {
      const double near = std::exp(-4 * (p.x * p.x + p.y * p.y) - 2 * (1 - p.z));
      return p - Vec3{0, 0, depth * near};
    };
  };
  EXPECT_LT(scoreOf(judge, surface, pushed(0.3)), scoreOf(judge, surface, pushed(0.9)));
  EXPECT_GT(scoreOf(judge, surface, pushed(1.6)), scoreOf(judge, surface, pushed(0.9)) + 0.1);
}

TEST(VolumeJudge, WhatHasNoInsideIsRefused) {
  ClosedSurface flat = ball();
  for (Vec3& p : flat.vertices) p.z = 0;
  EXPECT_THROW(VolumeJudge(flat, 1), DataError);
}

}  // namespace
}  // namespace innermap
