// Points on and around a solid's boundary, with the values that a field is to have there: what fits
// of one kind or the other are made from.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "innermap/core/matrix.h"
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

// The certificate: how far what was fitted is from its boundary values, typically and at most.
//
// What is fitted is smooth, its values are linear on triangles or anything else: the error stands
// out beside single vertices, where random points seldom fall. So after random points, which give
// what is typical without bias, it is measured at the vertices, and then where it was largest,
// closer and closer.

// Errors at points of solid.surface(), one a point, not negative.
using SurfaceErrors =
    std::function<std::vector<double>(const std::vector<SurfacePoint>& onSurface)>;

// Each vertex of the mesh once, at a corner of a triangle that has it; 200,000 of more.
std::vector<SurfacePoint> vertexPlaces(const Mesh& mesh);

struct CertificateSettings {
  std::size_t samples = kFreshSamples;  // uniform by area: those of freshSamples; in [1, 1e7]
  std::uint64_t seed = 1;               // that of the fit, in [0, 1e15]
  double tolerance = 0;                 // for BoundaryError::missed, in the units of `errors`
};

// rms, p99, sumOfSquares and samples of the random points alone; p99Bound and bound hold with
// kCertificateConfidence each:
//   p99Bound  the order statistic of the random points above which less than 1% of the area lies,
//             whatever the error is (binomial; David and Nagaraja, "Order Statistics", 2003);
//   max       the largest error met at random points, at the vertices (200,000 of them at most) and
//             in the search about the largest errors, in the units of `errors`;
//   bound     no error is larger: that of the random points alone for peaks of second order (de
//             Haan, "Estimation of the minimum of a function using order statistics", JASA 76,
//             1981), or a margin beyond what the search found; whichever is larger.
// Throws SettingError, what `errors` throws, Cancelled. Deterministic for any number of threads.
BoundaryError certify(const Solid& solid, const SurfaceErrors& errors,
                      const CertificateSettings& settings = {});

}  // namespace innermap
