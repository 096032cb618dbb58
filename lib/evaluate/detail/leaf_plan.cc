#include "evaluate/detail/leaf_plan.h"

#include <cmath>
#include <limits>

#include "innermap/levelset/level_set.h"

namespace innermap {
namespace {

// The surface may pass through a cell when its centre is nearer than half the cell's diagonal.
constexpr double kHalfDiagonal = 0.87;

Vec3 toVec3(const openvdb::Vec3d& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

LeafPlan planLeaf(const openvdb::MaskTree::LeafNodeType& leaf, const openvdb::FloatGrid& levelSet,
                  const Solid& solid) {
  LeafPlan out;
  const double voxel = levelSet.voxelSize()[0];
  auto distances = levelSet.getConstAccessor();
  for (auto it = leaf.cbeginValueOn(); it; ++it) {
    const openvdb::Coord ijk = it.getCoord();
    const double distance = distances.getValue(ijk);
    const auto offset = static_cast<std::uint16_t>(it.pos());
    const bool inside = distance < 0;
    if (inside) out.inside[offset >> 6] |= std::uint64_t{1} << (offset & 63);
    if (distance <= -kHalfDiagonal * voxel) continue;
    const Vec3 center = toVec3(levelSet.transform().indexToWorld(ijk));
    // Beyond its band the level set holds a constant.
    const bool inBand = distance < levelSet.background();
    const Solid::Closest closest =
        solid.closest(center, inBand ? 4 * voxel + 2 * std::abs(distance)
                                     : std::numeric_limits<double>::infinity());
    double share = inside ? 1 : 0;
    Vec3 at = center;
    if (closest.onSurface.triangle >= 0) {
      if (!inside) at = closest.position;
      const Vec3 away = (inside ? -1.0 : 1.0) * (center - closest.position);
      const double length = norm(away);
      share = length > 1e-12 * voxel
                  ? cellFraction((inside ? -length : length) / voxel, away / length)
                  : 0.5;
    }
    if (inside)
      out.cut.push_back({offset, share});
    else
      out.skin.push_back({offset, share, at, center - at});
  }
  return out;
}

}  // namespace innermap
