#include "fit/detail/map_certificate.h"

#include <algorithm>
#include <limits>

#include "fit/detail/problem_samples.h"
#include "fit/detail/streams.h"
#include "fit/detail/triangle_error.h"
#include "innermap/fit/surface_problem.h"
#include "sample/surface_samples.h"

namespace innermap {
namespace {

constexpr std::size_t kFirstLook = 400;
constexpr double kOfTheError = 1e-3, kLeastAccuracy = 1e-13;  // of sums
// Between vertices that a smooth map was fitted to, of the largest error at them. Measured: see the
// test of known functions.
constexpr double kBetweenVertices = 3;
// Neither what is beside the triangles looked at, nor what is of third order, is more than that.
constexpr double kTriangleMargin = 1.5;
constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();

std::vector<double> errorsAt(const ComposedMap& map, const BoundaryPair& pair,
                             const std::vector<SurfacePoint>& places, double accuracy) {
  EvaluateFieldSettings sums;
  sums.accuracy = accuracy;
  const Matrix wanted = pair.targetsOf(places),
               got = map.evaluate(positionsOf(pair.solid(), places), sums).values;
  std::vector<double> out(places.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Vec3 e{got(i, 0) - wanted(i, 0), got(i, 1) - wanted(i, 1), got(i, 2) - wanted(i, 2)};
    out[i] = norm(e) / pair.target.diagonal;
  }
  return out;
}

// What positions so far from the origin are rounded to.
double roundingOf(const BoundaryPair& pair) {
  const auto farthest = [](const Points& points) {
    double most = 0;
    for (const Vec3& p : points) most = std::max(most, norm(p));
    return most;
  };
  return kRounding * (farthest(pair.target.moved) / pair.target.diagonal +
                      farthest(pair.solid().surface().vertices) / pair.solid().diagonal());
}

// Of the mesh's own vertices that are exposed, not of pieces' corners.
std::vector<SurfacePoint> ownVertices(const Solid& solid) {
  std::vector<SurfacePoint> out;
  for (const SurfacePoint& p : vertexPlaces(solid.surface())) {
    const auto& b = solid.address(p).barycentric;
    if (std::max({b[0], b[1], b[2]}) > 1 - 1e-12) out.push_back(p);
  }
  return out;
}

double trianglesOff(const ComposedMap& map, const BoundaryPair& pair, double accuracy) {
  const auto slopes = [&](const Points& at, const Points& normals) {
    EvaluateFieldSettings sums;
    sums.accuracy = accuracy;
    sums.gradients = true;
    const Matrix g = map.evaluate(at, sums).gradients;
    std::vector<Vec3> out(at.size());
    for (std::size_t i = 0; i < at.size(); ++i)
      for (int r = 0; r < 3; ++r) {
        const std::size_t first = 3 * static_cast<std::size_t>(r);
        out[i][r] = dot({g(i, first), g(i, first + 1), g(i, first + 2)}, normals[i]);
      }
    return out;
  };
  return triangleError(pair.solid().repaired().mesh, pair.target.moved, slopes) /
         pair.target.diagonal;
}

// Of sums, world units of the target: changes no digit that counts of errors as large as the map's.
double certificateAccuracy(const ComposedMap& map, const BoundaryPair& pair, std::uint64_t seed) {
  SampleSettings sample;
  sample.seed = seedOf(seed, Stream::fresh);
  const std::vector<SurfacePoint> places =
      randomSamples(pair.solid().surface(), kFirstLook, sample);
  const double rms = summarizeErrors(errorsAt(map, pair, places, 0)).rms;
  return std::max(kOfTheError * rms, kLeastAccuracy) * pair.target.diagonal;
}

}  // namespace

MapCertificate certifyMap(const ComposedMap& map, const BoundaryPair& pair,
                          const MapCertificateSettings& settings) {
  const double accuracy = certificateAccuracy(map, pair, settings.seed);
  const auto errors = [&](const std::vector<SurfacePoint>& places) {
    return errorsAt(map, pair, places, accuracy);
  };
  CertificateSettings s;
  s.seed = settings.seed;
  s.tolerance = settings.tolerance;
  MapCertificate out;
  out.accuracy = accuracy;
  out.error = certify(pair.solid(), errors, s);
  const double rounding = roundingOf(pair);
  out.error.bound += rounding;
  if (settings.smooth) {
    for (const double e : errors(ownVertices(pair.solid())))
      out.verticesMax = std::max(out.verticesMax, e);
    out.smoothBound = kBetweenVertices * out.verticesMax + rounding;
  } else {
    out.triangles = trianglesOff(map, pair, accuracy);
    out.smoothBound = out.error.bound + kTriangleMargin * out.triangles;
  }
  return out;
}

}  // namespace innermap
