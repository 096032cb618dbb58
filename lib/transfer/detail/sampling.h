// A grid's value at a point in world space.
#pragma once

#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

#include <cmath>
#include <type_traits>

#include "innermap/core/vec3.h"
#include "innermap/transfer/carry.h"

namespace innermap {

template <class Value>
constexpr bool kIsVector = openvdb::VecTraits<Value>::IsVec;

// Whole numbers and truth values have no values in between.
template <class Value>
constexpr bool kIsDiscrete = std::is_integral_v<Value> || std::is_same_v<Value, openvdb::Vec3i>;

// For one thread: it keeps an accessor.
template <class Grid>
class PointwiseSampler {
 public:
  using Value = typename Grid::ValueType;

  PointwiseSampler(const Grid& grid, Sampling sampling)
      : accessor_(grid.tree()),
        transform_(grid.transform()),
        background_(grid.background()),
        sampling_(kIsDiscrete<Value> ? Sampling::nearest : sampling),
        staggered_(grid.getGridClass() == openvdb::GRID_STAGGERED) {}

  // The background where the point is beyond all indices.
  Value at(const Vec3& p) const {
    constexpr double kFarthest = 1e9;
    const openvdb::Vec3d ijk = transform_.worldToIndex(openvdb::Vec3d(p.x, p.y, p.z));
    if (!(std::abs(ijk.x()) < kFarthest && std::abs(ijk.y()) < kFarthest &&
          std::abs(ijk.z()) < kFarthest))
      return background_;
    if constexpr (kIsDiscrete<Value>)
      return openvdb::tools::PointSampler::sample(accessor_, ijk);
    else
      return between(ijk);
  }

 private:
  Value between(const openvdb::Vec3d& ijk) const {
    namespace vdb = openvdb::tools;
    if constexpr (kIsVector<Value>)
      if (staggered_)
        return sampling_ == Sampling::nearest  ? sample<vdb::StaggeredPointSampler>(ijk)
               : sampling_ == Sampling::linear ? sample<vdb::StaggeredBoxSampler>(ijk)
                                               : sample<vdb::StaggeredQuadraticSampler>(ijk);
    return sampling_ == Sampling::nearest  ? sample<vdb::PointSampler>(ijk)
           : sampling_ == Sampling::linear ? sample<vdb::BoxSampler>(ijk)
                                           : sample<vdb::QuadraticSampler>(ijk);
  }

  template <class Sampler>
  Value sample(const openvdb::Vec3d& ijk) const {
    return Sampler::sample(accessor_, ijk);
  }

  // Not registered with the tree, which stays as it is; the registry compiles for seconds.
  openvdb::tree::ValueAccessor<const typename Grid::TreeType, false> accessor_;
  const openvdb::math::Transform& transform_;
  Value background_;
  Sampling sampling_;
  bool staggered_;
};

}  // namespace innermap
