#include "texture/detail/near_segments.h"

#include <algorithm>
#include <cmath>

#include "core/require_number.h"
#include "innermap/core/run.h"

namespace innermap {

double Segment::distance(const Vec3& p) const {
  const Vec3 along = to - from;
  const double length = squaredNorm(along);
  const double t = length > 0 ? std::clamp(dot(p - from, along) / length, 0.0, 1.0) : 0;
  return norm(p - from - t * along);
}

openvdb::MaskGrid::Ptr voxelsNear(const std::vector<Segment>& segments,
                                  const openvdb::FloatGrid& levelSet, double reach) {
  requireNumber("reach", reach, above(0));
  auto out = openvdb::MaskGrid::create();
  out->setTransform(levelSet.transform().copy());
  auto near = out->getAccessor();
  const auto distances = levelSet.getConstAccessor();
  const double voxel = levelSet.voxelSize()[0];
  const int radius = static_cast<int>(std::ceil(reach / voxel)) + 1;
  const auto index = [&](const Vec3& p) {
    return openvdb::Coord::round(levelSet.worldToIndex(openvdb::Vec3d(p.x, p.y, p.z)));
  };
  for (const Segment& s : segments) {
    throwIfCancelled();
    const Vec3 along = s.to - s.from;
    const int steps = std::max(1, static_cast<int>(std::ceil(norm(along) / (4 * voxel))));
    for (int i = 0; i < steps; ++i) {
      // The box about this part of the segment.
      openvdb::CoordBBox box(index(s.from + (1.0 * i / steps) * along),
                             index(s.from + (1.0 * i / steps) * along));
      box.expand(index(s.from + ((i + 1.0) / steps) * along));
      box.expand(radius);
      for (auto at = box.begin(); at != box.end(); ++at) {
        if (!(distances.getValue(*at) < 0) || near.isValueOn(*at)) continue;
        const openvdb::Vec3d p = levelSet.indexToWorld(*at);
        if (s.distance({p.x(), p.y(), p.z()}) <= reach) near.setValueOn(*at);
      }
    }
  }
  return out;
}

}  // namespace innermap
