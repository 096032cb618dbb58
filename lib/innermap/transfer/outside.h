// A map beyond its solid, for smoke around a body.
//
// Outside, the map is never evaluated (its charges stand there) but extended from the closest
// boundary point c: E(p) = f(c) + J(c) (p - c). Up to a stated distance it is that, faded to a
// rigid motion or cut off where it ends.
#pragma once

#include <array>
#include <optional>

#include "innermap/core/setting.h"
#include "innermap/core/vec3.h"

namespace innermap {

struct RigidMotion {
  Mat3 rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3 translation;  // p -> rotation p + translation, world units

  Vec3 operator()(const Vec3& p) const;
};

// Whether its matrix is a rotation, by entries within the tolerance (numbers are written with a few
// digits).
bool isRigid(const RigidMotion& motion, double tolerance = 1e-4);

// The rigid motion that moves `from` onto `to` best by least squares; same number of points, not
// all in one line. Horn, "Closed-form solution of absolute orientation using unit quaternions" (J.
// Opt. Soc. Am. A, 1987). Throws DataError when there are fewer than three pairs.
RigidMotion bestRigidMotion(const Points& from, const Points& to);

struct OutsideSettings {
  double distance = 0;  // fraction of the source's diagonal, in [0, 1]; 0: the solid alone
  // Where the extension fades to by `distance`, and what moves the rest of the grids beyond;
  // without one they are cut off there.
  std::optional<RigidMotion> fadeTo;
};

// Of OutsideSettings::distance.
inline Setting outsideSetting(double* distance) {
  return Setting("outside", "D", distance,
                 "carry also what is around the solid, up to this distance from it")
      .in("fraction of the diagonal")
      .from(0, 1);
}

}  // namespace innermap
