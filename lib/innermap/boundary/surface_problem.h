// Points on and around a solid's boundary, with the values that a field is to have there: what fits
// of one kind or the other are made from.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/field/adaptive_fit.h"
#include "innermap/field/fit.h"
#include "innermap/levelset/solid.h"

namespace innermap {

// Boundary values at points of solid.surface(): #points x #K. May be called from any thread.
using SurfaceValues = std::function<Matrix(const std::vector<SurfacePoint>& onSurface)>;

// As Collocation::directions: where one is not zero, the values are derivatives. May be called from
// any thread.
using SurfaceDirections = std::function<Points(const std::vector<SurfacePoint>& onSurface)>;

struct SurfaceProblemSettings {
  std::size_t collocation = 8000;  // boundary points to fit to, in [8, 1e7]; blue noise
  std::size_t heldOut = 2000;      // random boundary points that choose between fits
  SurfaceDirections directions;    // none: values everywhere
  std::uint64_t seed = 1;          // of all random points, in [0, 1e15]
};

// For fitField: a number of charges on a shell about the solid. Throws DataError, Cancelled.
FitProblem surfaceProblem(const Solid& solid, const SurfaceValues& values,
                          const SurfaceProblemSettings& settings = {});

struct AdaptiveProblemSettings {
  SurfaceDirections directions;  // none: values everywhere
  std::uint64_t seed = 1;        // as above
};

// For fitToTolerance: charges where the error is. unit: what errors are fractions of, the values'
// extent, in their units.
AdaptiveProblem adaptiveProblem(const Solid& solid, const SurfaceValues& values, double unit,
                                const AdaptiveProblemSettings& settings = {});

// Of the certificate.
constexpr std::size_t kFreshSamples = 20000;

struct FreshSampleSettings {
  SurfaceDirections directions;  // none: values everywhere
  std::size_t count = kFreshSamples;
  std::uint64_t seed = 1;  // that of the fit: no point of its problem is among these
};

// Random points of the boundary, uniform by area, that no problem of the same seed has: for an
// error without bias. They are draw 0 of the adaptive problem.
BoundarySamples freshSamples(const Solid& solid, const SurfaceValues& values,
                             const FreshSampleSettings& settings = {});

}  // namespace innermap
