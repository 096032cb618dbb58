// The points of a surface problem, as places on the surface.
#pragma once

#include <vector>

#include "innermap/boundary/surface_problem.h"

namespace innermap {

struct ProblemSamples {
  std::vector<SurfacePoint> collocation, heldOut;  // on solid.surface()
};

ProblemSamples drawSamples(const Solid& solid, const SurfaceProblemSettings& settings);

FitProblem problemOf(const Solid& solid, const SurfaceValues& values, const ProblemSamples& samples,
                     const SurfaceProblemSettings& settings);

Points positionsOf(const Solid& solid, const std::vector<SurfacePoint>& onSurface);

}  // namespace innermap
