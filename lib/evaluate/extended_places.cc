#include "evaluate/extended_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {

// From a voxel the distance changes by no more than the way from there.
int SideOfSurface::sure(const Vec3& p) const {
  constexpr double kRounding = 1e-5;  // of floats, voxels
  constexpr double kFar = 1e8;        // beyond any level set
  const double voxel = levelSet_.voxelSize()[0];
  const openvdb::Vec3d ijk = levelSet_.transform().worldToIndex(openvdb::Vec3d(p.x, p.y, p.z));
  if (!(std::abs(ijk.x()) < kFar && std::abs(ijk.y()) < kFar && std::abs(ijk.z()) < kFar)) return 1;
  const openvdb::Coord base = openvdb::Coord::floor(ijk);
  for (int c = 0; c < 8; ++c) {
    const openvdb::Coord corner = base.offsetBy(c >> 2, c >> 1 & 1, c & 1);
    const double way = (ijk - corner.asVec3d()).length() + kRounding,
                 distance = distances_.getValue(corner) / voxel;
    if (distance > way) return 1;
    if (distance < -way) return -1;
  }
  return 0;
}

// By the side of the triangle that the closest point lies in; at edges and corners, where that may
// mislead, by the winding number.
bool SideOfSurface::inside(const Vec3& p, const Solid::Closest& closest) const {
  constexpr double kWithin = 1e-6;
  const std::array<double, 3>& w = closest.onSurface.barycentric;
  if (closest.distance > 0 && std::min({w[0], w[1], w[2]}) > kWithin)
    return dot(p - closest.position, areaVector(solid_.surface(), closest.onSurface.triangle)) < 0;
  return solid_.inside(p);
}

ExtendedPlaces placeExtended(const Solid& solid, const openvdb::FloatGrid& levelSet,
                             const Points& points) {
  constexpr std::size_t kBlock = 256;
  ExtendedPlaces out{points, Points(points.size())};
  parallelBlocks(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    const SideOfSurface side(solid, levelSet);
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3& p = points[i];
      if (!isFinite(p)) throw DataError("points: a coordinate is not finite");
      const int sign = side.sure(p);
      if (sign < 0) continue;
      const Solid::Closest closest = solid.closest(p, std::numeric_limits<double>::infinity());
      if (sign == 0 && side.inside(p, closest)) continue;
      out.at[i] = closest.position;
      out.beyond[i] = p - closest.position;
    }
  });
  return out;
}

}  // namespace innermap
