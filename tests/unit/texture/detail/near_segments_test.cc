#include "texture/detail/near_segments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "core/random.h"
#include "innermap/core/error.h"
#include "innermap/levelset/level_set.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

TEST(NearSegments, DistanceToASegment) {
  const Segment s{{0, 0, 0}, {2, 0, 0}};
  EXPECT_NEAR(s.distance({1, 3, 0}), 3, 1e-12);
  EXPECT_NEAR(s.distance({-3, 4, 0}), 5, 1e-12);
  EXPECT_NEAR(s.distance({5, 0, 4}), 5, 1e-12);
  EXPECT_NEAR((Segment{{1, 1, 1}, {1, 1, 1}}.distance({1, 1, 3})), 2, 1e-12);
}

// Against the distance of every voxel to every segment.
TEST(NearSegments, FindsTheVoxelsOfABallAlongRandomSegments) {
  openvdb::initialize();
  const Solid solid(shapes::icosphere(2));
  const auto levelSet = makeLevelSet(solid, {.resolution = 24});
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const CounterRandom random(seed, 9);
    std::vector<Segment> segments;
    for (std::uint64_t i = 0; i < 5; ++i)
      segments.push_back(
          {shapes::randomPoint(random, 2 * i), shapes::randomPoint(random, 2 * i + 1)});
    const double reach = (0.5 + 2 * random.uniform(99)) * levelSet->voxelSize()[0];
    const auto near = voxelsNear(segments, *levelSet, reach);
    std::size_t expected = 0;
    const openvdb::CoordBBox box = levelSet->evalActiveVoxelBoundingBox();
    for (auto it = box.begin(); it != box.end(); ++it) {
      if (!(levelSet->tree().getValue(*it) < 0)) continue;
      const openvdb::Vec3d p = levelSet->indexToWorld(*it);
      const bool in = std::any_of(segments.begin(), segments.end(), [&](const Segment& s) {
        return s.distance({p.x(), p.y(), p.z()}) <= reach;
      });
      expected += in;
      EXPECT_EQ(near->tree().isValueOn(*it), in);
    }
    EXPECT_EQ(near->activeVoxelCount(), expected);
    EXPECT_GT(expected, 0u);
  }
  EXPECT_THROW(voxelsNear({}, *levelSet, 0), SettingError);
  EXPECT_EQ(voxelsNear({}, *levelSet, 1)->activeVoxelCount(), 0u);
}

}  // namespace
}  // namespace innermap
