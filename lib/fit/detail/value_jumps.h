// Where exposed parts of a solid meet and do not move alike.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/levelset/solid.h"

namespace innermap {

struct ValueJump {
  Vec3 place;       // on the solid's surface
  double size = 0;  // how far apart the values on both sides are, their units
};

// The lines along which triangles of a solid's repaired mesh cross each other at its exposed
// surface, by places no farther apart than a five-hundredth of the diagonal. None where nothing
// overlaps.
class CrossingLines {
 public:
  // Throws Cancelled.
  explicit CrossingLines(const Solid& solid);

  // Values at addresses on repaired().mesh, #addresses x #channels; NaN where none is given.
  using Values = std::function<Matrix(const std::vector<SurfacePoint>&)>;
  // The places at which the values of the two sides differ by more than `least`.
  std::vector<ValueJump> jumps(const Values& values, double least) const;
  // Of values at the vertices of repaired().mesh, linear on triangles.
  std::vector<ValueJump> jumps(const Solid& solid, const Points& values, double least) const;

 private:
  Points places_;
  std::array<std::vector<SurfacePoint>, 2> sides_;  // of each place
};

// What to say of the largest; unit: of the sizes. Empty without jumps.
std::string jumpsText(const std::vector<ValueJump>& jumps, double unit,
                      const std::string& unitName);

}  // namespace innermap
