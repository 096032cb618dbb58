#include "transfer/detail/split_tetrahedron.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "transfer/test_maps.h"

namespace innermap {
namespace {

using Corners = std::array<TetrahedronCorner, 4>;
using Shares = std::map<openvdb::Coord, VolumeAndMass>;

Shares split(const Corners& c, double volume = 1) {
  Shares out;
  splitAtVoxels({&c[0], &c[1], &c[2], &c[3]}, volume,
                [&](const openvdb::Coord& voxel, double v, double m) {
                  out[voxel].volume += v;
                  out[voxel].mass += m;
                });
  return out;
}

VolumeAndMass sumOf(const Shares& shares) {
  VolumeAndMass out;
  for (const auto& [voxel, share] : shares) {
    out.volume += share.volume;
    out.mass += share.mass;
  }
  return out;
}

// Some with corners on planes between voxels, some flat or no more than a line or a point.
Corners randomCorners(test::Draws& random, int kind) {
  Corners out;
  for (TetrahedronCorner& c : out) {
    for (double& x : c.at) {
      x = -3 + 6 * random();
      if (kind % 3 == 1) x = std::round(x);
    }
    if (kind % 5 >= 2) c.at[2] = 1.25;
    if (kind % 5 >= 3) c.at[1] = -1;
    if (kind % 5 == 4) c.at[0] = 2.5;
    c.density = random();
  }
  return out;
}

TEST(SplitTetrahedron, PartsMakeUpTheWhole) {
  const std::uint64_t seed = 20;
  SCOPED_TRACE(seed);
  test::Draws random(seed);
  for (int i = 0; i < 3000; ++i) {
    const Corners c = randomCorners(random, i);
    const Shares shares = split(c, 2);
    const VolumeAndMass sum = sumOf(shares);
    const double mean = 0.25 * (c[0].density + c[1].density + c[2].density + c[3].density);
    ASSERT_NEAR(sum.volume, 2, 1e-12) << i;
    ASSERT_NEAR(sum.mass, 2 * mean, 1e-12) << i;
    for (const auto& [voxel, share] : shares)
      for (int a = 0; a < 3; ++a) {
        double lower = 1e9, upper = -1e9;
        for (const TetrahedronCorner& corner : c) {
          lower = std::min(lower, corner.at[static_cast<std::size_t>(a)]);
          upper = std::max(upper, corner.at[static_cast<std::size_t>(a)]);
        }
        ASSERT_GE(voxel[a] + 1, lower - 1e-12) << i;
        ASSERT_LE(voxel[a], upper + 1e-12) << i;
      }
  }
}

// Against points spread evenly through the tetrahedron.
TEST(SplitTetrahedronRelease, EachVoxelGetsWhatLiesInIt) {
  const std::uint64_t seed = 21;
  SCOPED_TRACE(seed);
  test::Draws random(seed);
  for (int i = 0; i < 20; ++i) {
    const Corners c = randomCorners(random, 0);
    const Shares shares = split(c);
    Shares counted;
    constexpr int kPoints = 100000;
    for (int n = 0; n < kPoints; ++n) {
      // Sorted, three uniform numbers cut [0, 1] into uniform barycentric coordinates.
      std::array<double, 5> cut{0, random(), random(), random(), 1};
      std::sort(cut.begin(), cut.end());
      openvdb::Vec3d at(0);
      double density = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        at += (cut[k + 1] - cut[k]) * openvdb::Vec3d(c[k].at[0], c[k].at[1], c[k].at[2]);
        density += (cut[k + 1] - cut[k]) * c[k].density;
      }
      VolumeAndMass& share = counted[openvdb::Coord::floor(at)];
      share.volume += 1.0 / kPoints;
      share.mass += density / kPoints;
    }
    for (const auto& [voxel, share] : counted) {
      ASSERT_NEAR(shares.count(voxel) ? shares.at(voxel).volume : 0, share.volume, 0.007) << voxel;
      ASSERT_NEAR(shares.count(voxel) ? shares.at(voxel).mass : 0, share.mass, 0.007) << voxel;
    }
  }
}

// x + y + z <= 2 in the first octant: by hand.
TEST(SplitTetrahedron, TheCornerOfACube) {
  const Corners c{{{{0, 0, 0}, 1}, {{2, 0, 0}, 1}, {{0, 2, 0}, 1}, {{0, 0, 2}, 1}}};
  const Shares shares = split(c, 8);
  EXPECT_NEAR(shares.at({0, 0, 0}).volume, 5, 1e-12);
  for (const openvdb::Coord& voxel :
       {openvdb::Coord(1, 0, 0), openvdb::Coord(0, 1, 0), openvdb::Coord(0, 0, 1)})
    EXPECT_NEAR(shares.at(voxel).volume, 1, 1e-12);
}

}  // namespace
}  // namespace innermap
