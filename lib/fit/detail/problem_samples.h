// The points of a surface problem, as places on the surface.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/field/fit.h"
#include "innermap/levelset/solid.h"

namespace innermap {

struct ProblemSamples {
  std::vector<SurfacePoint> collocation, heldOut;  // on solid.surface()
};

struct PointCounts {
  std::size_t sources = 0, collocation = 0, heldOut = 0;
};

ProblemSamples drawSamples(const Solid& solid, const PointCounts& counts, std::uint64_t seed);

// values: as SurfaceValues in surface_problem.h.
FitProblem problemOf(const Solid& solid,
                     const std::function<Matrix(const std::vector<SurfacePoint>&)>& values,
                     const ProblemSamples& samples, std::uint64_t seed);

Points positionsOf(const Solid& solid, const std::vector<SurfacePoint>& onSurface);

}  // namespace innermap
