// Points carried through the map of a solid, and back, with its derivative at each.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/field/harmonic_map.h"
#include "innermap/levelset/solid.h"
#include "innermap/transfer/outside.h"

namespace innermap {

struct CarryPointsSettings {
  OutsideSettings outside;
  // Points that are no farther outside are taken for points of the boundary and carried whatever
  // `outside` says: fraction of the source's diagonal, in [0, 0.1]. Two surfaces that are meant to
  // be one differ by that much.
  double skin = 1e-3;
  double accuracy = 1e-7;  // of the sums of charges, as EvaluateSettings::accuracy
};

// Throws SettingError for a number out of its range.
void requireInRange(const CarryPointsSettings& settings);

enum class PointFate : std::uint8_t {
  carried,
  cut,    // too far outside the solid; it has no place
  failed  // the map was not inverted there; it has the place of the nearest point found
};

struct CarriedPoints {
  Points points;                // #points, world units
  std::vector<Mat3> jacobians;  // #points, of the way taken; empty when not asked for
  std::vector<PointFate> fates;
  // Of all: outside the solid by over 1e-6 of its diagonal, whatever their fate; and the rest.
  std::uint64_t outside = 0, cut = 0, failed = 0;
  double farthest = 0;  // of those outside and not cut, fraction of the source's diagonal
};

// Carries #points; with jacobians if asked for.
using PointCarry = std::function<CarriedPoints(const Points& points, bool jacobians)>;

// From the source to the target: x becomes f(x), the Jacobian is f's. Outside the solid the map is
// extended as transfer/outside.h says. Holds copies, which share their data; serves any number of
// maps.
class PointPusher {
 public:
  // Throws SettingError, MemoryError, Cancelled.
  explicit PointPusher(const Solid& source, const CarryPointsSettings& settings = {});

  // Same result for any number of threads. Throws DataError for a point that is not finite,
  // Cancelled.
  CarriedPoints push(const ComposedMap& map, const Points& points, bool jacobians) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

// From the target to the source: y becomes the x with f(x) = y, the Jacobian is the inverse of f's
// there. The inverse on a grid of the target gives the starts (see inverse_map.h), Newton's method
// does the rest, to 1e-5 of the target's diagonal and mostly to `accuracy`.
class PointPuller {
 public:
  // Inverts the map on the grid. Throws as invertMap does.
  PointPuller(const ComposedMap& map, const Solid& source, const Solid& target,
              const CarryPointsSettings& settings = {});

  // Throws as PointPusher::push.
  CarriedPoints pull(const Points& points, bool jacobians) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

// Peak need in bytes of carrying so many points, beyond the points given: with Jacobians or
// without.
std::uint64_t carryPointsMemory(std::uint64_t points, bool jacobians);

// What of a vector or a normal becomes of it, A being the Jacobian: A v; and A^-T n, as long as n
// was. A normal stays as it is where A is singular.
Vec3 carriedVector(const Mat3& jacobian, const Vec3& v);
Vec3 carriedNormal(const Mat3& jacobian, const Vec3& n);

}  // namespace innermap
