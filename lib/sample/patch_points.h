// Points on and around the part of a solid's boundary that is near given marks: what an adaptive
// fit adds where its error is.
//
// Dart throwing (Cook, "Stochastic Sampling in Computer Graphics", 1986) in rounds of random
// candidates until hardly any finds room; where some in a row found none, no more are thrown. The
// result is near to maximal, the same for any number of threads. All lengths are fractions of the
// solid's diagonal.
#pragma once

#include <cstdint>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/levelset/solid.h"

namespace innermap {

struct PatchSettings {
  double spacing = 0.01;  // no two points are nearer to each other; positive
  // Points stand on, or over, the boundary nearer than this to a mark; positive. Without marks: on
  // all of the boundary.
  double reach = 0.02;
  std::size_t most = 10'000'000;  // points; when there are more, a random choice of them
  std::uint64_t seed = 1;
};

// Points outside the solid whose distance from its boundary is `distance`, in [1e-6, 2], to 3%:
// where another part of the boundary is nearer (in a narrow gap) there are none. Each is checked to
// be outside. None is nearer than the spacing to a point of `existing`. May be empty. Throws
// SettingError, Cancelled.
Points patchSources(const Solid& solid, const Points& marks, double distance,
                    const Points& existing, const PatchSettings& settings);

// Samples of solid.surface(), likewise.
std::vector<SurfacePoint> patchSamples(const Solid& solid, const Points& marks,
                                       const Points& existing, const PatchSettings& settings);

}  // namespace innermap
