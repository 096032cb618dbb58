// Which side of a solid's surface points are on, and where a field that is extended beyond it is
// evaluated for them.
#pragma once

#include <openvdb/openvdb.h>

#include "innermap/core/vec3.h"
#include "innermap/levelset/solid.h"

namespace innermap {

// Holds references and an accessor: one a thread. levelSet: of `solid`.
class SideOfSurface {
 public:
  SideOfSurface(const Solid& solid, const openvdb::FloatGrid& levelSet)
      : solid_(solid), levelSet_(levelSet), distances_(levelSet.getConstAccessor()) {}

  // Sign of the distance where the level set tells it for sure, else 0: near the surface.
  int sure(const Vec3& p) const;

  // Whether a point near the surface is inside, given the point of the surface closest to it.
  bool inside(const Vec3& p, const Solid::Closest& closest) const;

 private:
  const Solid& solid_;
  const openvdb::FloatGrid& levelSet_;
  openvdb::FloatGrid::ConstAccessor distances_;
};

// at: the points themselves where they are inside, else the points of the surface closest to them.
// beyond: from there to the points, zero inside. World units.
struct ExtendedPlaces {
  Points at, beyond;
};

// levelSet only tells which points are near the surface. Throws DataError for a point that is not
// finite, Cancelled.
ExtendedPlaces placeExtended(const Solid& solid, const openvdb::FloatGrid& levelSet,
                             const Points& points);

}  // namespace innermap
