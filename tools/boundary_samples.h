// Points on and around a pair of boundaries, with where they go: what fits are made from.
#pragma once

#include <functional>

#include "boundary_pair.h"
#include "fitting_options.h"
#include "innermap/field/adaptive_fit.h"
#include "innermap/field/fit.h"

namespace innermap::tool {

// Boundary values at points of a solid's surface: #points x #K.
using ValuesOf = std::function<Matrix(const std::vector<SurfacePoint>& onSurface)>;

// For a number of charges on a shell about any solid, fitted to any values on its surface. Holds
// references to the solid and the context.
FitProblem surfaceProblem(const Solid& solid, const ValuesOf& values, std::uint64_t seed,
                          const PointCounts& counts, Context& context);

// For a number of charges on a shell or sphere.
FitProblem fitProblem(const BoundaryPair& pair, const FittingOptions& options,
                      const PointCounts& counts, Context& context);

// For charges where the error is. Holds references to all arguments.
AdaptiveProblem adaptiveProblem(const BoundaryPair& pair, const FittingOptions& options,
                                Context& context);

// Random points that no fit sees; the adaptive problem's draw 0.
constexpr std::size_t kFreshSamples = 20000;
BoundarySamples freshSamples(const BoundaryPair& pair, const FittingOptions& options,
                             Context& context);
BoundarySamples freshSamples(const Solid& solid, const ValuesOf& values, std::uint64_t seed,
                             Context& context);

}  // namespace innermap::tool
