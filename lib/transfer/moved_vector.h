// What a linear map makes of a vector of a grid.
#pragma once

#include <openvdb/openvdb.h>

#include "innermap/core/vec3.h"

namespace innermap {

// By OpenVDB's vector types; those that stay, and positions, as they are.
inline Vec3 movedVector(const Vec3& v, const Mat3& a, openvdb::VecType type) {
  switch (type) {
    case openvdb::VEC_COVARIANT:
      return transposed(inverse(a)) * v;
    case openvdb::VEC_COVARIANT_NORMALIZE: {
      const Vec3 moved = transposed(inverse(a)) * v;
      const double length = norm(moved);
      return length > 0 ? moved / length : moved;
    }
    case openvdb::VEC_CONTRAVARIANT_RELATIVE:
      return a * v;
    default:
      return v;
  }
}

}  // namespace innermap
