// A map both ways that is given point by point, in place of a harmonic one: a repaired mesh as a
// piecewise linear map, say.
#pragma once

#include <openvdb/openvdb.h>

#include <functional>

#include "innermap/core/vec3.h"
#include "innermap/transfer/inverse_map.h"

namespace innermap {

// Each carries #points and gives the Jacobian of the way taken at each; for points anywhere, also
// outside. Deterministic.
struct ThroughMap {
  std::function<void(const Points& points, Points& images, std::vector<Mat3>& jacobians)> push;
  std::function<void(const Points& points, Points& images, std::vector<Mat3>& jacobians)> pull;
};

// Calls use(leaf's origin, places of its active voxels' centres in world units, images, Jacobians)
// for each leaf of the region in order, some of them side by side on the way there. Throws
// Cancelled.
void forLeavesThrough(
    const openvdb::MaskGrid& region,
    const std::function<void(const Points&, Points&, std::vector<Mat3>&)>& way,
    const std::function<void(std::size_t leaf, const openvdb::Coord& origin, const Points& images,
                             const std::vector<Mat3>& jacobians)>& use);

// The inverse at the voxels of a region of the target.
InvertedMap invertThrough(const ThroughMap& through, const openvdb::MaskGrid::Ptr& region);

}  // namespace innermap
