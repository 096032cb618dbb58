// The certificate: how far what was fitted is from its boundary values, typically and at most.
//
// What is fitted is smooth, its values are linear on triangles or anything else: the error stands
// out beside single vertices, where random points seldom fall. So after random points, which give
// what is typical without bias, it is measured at the vertices, and then where it was largest,
// closer and closer.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "innermap/boundary/surface_problem.h"
#include "innermap/field/boundary_error.h"
#include "innermap/levelset/solid.h"

namespace innermap {

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
