#include "innermap/fit/fit_harmonic.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/point_grid.h"
#include "fit/detail/problem_samples.h"
#include "fit/detail/surface_conditions.h"
#include "fit/detail/value_jumps.h"
#include "innermap/fit/fit_map.h"
#include "innermap/fit/surface_problem.h"

namespace innermap {
namespace {

constexpr std::size_t kFewSources = 1000, kPointsOfFew = 4000;
constexpr double kSumsOfTolerance = 1e-3;  // accuracy of sums
// Of the comparison: it need not be exact.
constexpr double kOfComparison = 0.05;
constexpr std::size_t kMostOfComparison = 4000;

AdaptiveProblemSettings problemSettings(const SurfaceConditions& conditions,
                                        const HarmonicFitSettings& settings) {
  AdaptiveProblemSettings s;
  s.seed = settings.seed;
  if (conditions.anyFree())
    s.directions = [&conditions](const auto& at) { return conditions.directions(at); };
  return s;
}

AdaptiveProblem problemOf(const SourceBoundary& boundary, const SurfaceConditions& conditions,
                          double span, const HarmonicFitSettings& settings) {
  return adaptiveProblem(
      boundary.solid, [&conditions](const auto& at) { return conditions.rows(at); }, span,
      problemSettings(conditions, settings));
}

// The largest of a channel's values and of what fluxes come to.
double spanOf(const BoundarySamples& samples) {
  const Collocation at = samples.collocation();
  double out = 0;
  for (std::size_t k = 0; k < samples.values.columns(); ++k) {
    double low = INFINITY, high = -INFINITY, flux = 0;
    for (std::size_t i = 0; i < at.size(); ++i) {
      const double value = samples.values(i, k);
      if (at.derivative(i)) {
        flux = std::max(flux, std::abs(value));
      } else {
        low = std::min(low, value);
        high = std::max(high, value);
      }
    }
    out = std::max({out, high - low, flux});
  }
  return out;
}

double accuracyOf(const HarmonicFitSettings& settings, double span) {
  return kSumsOfTolerance * settings.tolerance * span;
}

struct Fitted {
  HarmonicField field;
  AdaptiveEnd end = AdaptiveEnd::met;
  std::size_t collocation = 0;
};

Fitted fittedWhereNeeded(const SourceBoundary& boundary, const SurfaceConditions& conditions,
                         double span, const HarmonicFitSettings& settings,
                         const std::vector<ValueJump>& jumps) {
  AdaptiveSettings s;
  s.tolerance = settings.tolerance;
  s.maxSources = settings.maxSources;
  AdaptiveProblem problem = problemOf(boundary, conditions, span, settings);
  for (const ValueJump& jump : jumps) problem.jumps.push_back(jump.place);
  const AdaptiveResult fit = fitToTolerance(problem, s);
  return {fit.field, fit.end, fit.collocation};
}

// A few charges, as far away as they do best: smooth data need no more. Nothing where they miss the
// tolerance.
std::optional<Fitted> fittedByFew(const SourceBoundary& boundary,
                                  const SurfaceConditions& conditions, double span,
                                  const HarmonicFitSettings& settings) {
  SurfaceProblemSettings points;
  points.collocation = kPointsOfFew;
  points.heldOut = kFewSources;
  points.directions = problemSettings(conditions, settings).directions;
  points.seed = settings.seed;
  const FitProblem problem = surfaceProblem(
      boundary.solid, [&conditions](const auto& at) { return conditions.rows(at); }, points);
  FitSettings s;
  s.sources = kFewSources;
  s.interpolation = Interpolation::linear;
  const FitResult fit = fitField(problem, s);
  const BoundarySamples fresh =
      problemOf(boundary, conditions, span, settings).draw(kFreshSamples, 0);
  const BoundaryError error = measureBoundaryError(fit.field, fresh.collocation(), fresh.values,
                                                   span, {accuracyOf(settings, span)});
  if (error.p99 > settings.tolerance) return std::nullopt;
  return Fitted{fit.field, AdaptiveEnd::met, problem.surface.points.size()};
}

struct Certified {
  BoundaryError error;
  double values = 0;  // the largest error where values are given
};

Certified certifyField(const SourceBoundary& boundary, const SurfaceConditions& conditions,
                       const HarmonicField& field, double span,
                       const HarmonicFitSettings& settings) {
  Certified out;
  CertificateSettings s;
  s.seed = settings.seed;
  const auto errors = [&](const std::vector<SurfacePoint>& places) {
    const Collocation at(positionsOf(boundary.solid, places), conditions.directions(places));
    const std::vector<double> found =
        boundaryErrors(field, at, conditions.rows(places), span, {accuracyOf(settings, span)});
    for (std::size_t i = 0; i < found.size(); ++i)
      if (!at.derivative(i)) out.values = std::max(out.values, found[i]);
    return found;
  };
  out.error = certify(boundary.solid, errors, s);
  return out;
}

// The largest of the points' numbers about each place.
class Envelope {
 public:
  Envelope(const Points& points, std::vector<double> numbers, double reach)
      : grid_(points, reach), numbers_(std::move(numbers)), reach_(reach) {}

  double operator()(const Vec3& place) const {
    double most = 0;
    bool any = false;
    for (double reach = reach_; !any && reach < kFarthest * reach_; reach *= 2)
      for (const std::size_t j : grid_.within({place, place}, reach)) {
        most = std::max(most, numbers_[j]);
        any = true;
      }
    return most;
  }

 private:
  static constexpr double kFarthest = 64;
  PointGrid grid_;
  std::vector<double> numbers_;
  double reach_;
};

// A harmonic function whose values and fluxes are nowhere less than the errors' is nowhere less
// than the error.
double comparisonBound(const SourceBoundary& boundary, const SurfaceConditions& conditions,
                       const Certified& certified, const HarmonicField& field, double span,
                       const HarmonicFitSettings& settings) {
  const BoundarySamples samples =
      problemOf(boundary, conditions, span, settings).draw(kFreshSamples, 0);
  const Collocation at = samples.collocation();
  const std::vector<double> errors =
      boundaryErrors(field, at, samples.values, span, {accuracyOf(settings, span)});
  Points places;
  std::vector<double> known;
  double largest = certified.values;
  for (const std::size_t i : derivativeRows(at)) {
    places.push_back(at.points[i]);
    known.push_back(errors[i]);
    largest = std::max(largest, errors[i]);
  }
  if (!(largest > 0)) return 0;
  const Envelope envelope(places, std::move(known),
                          2 * std::sqrt(boundary.solid.area() / kFreshSamples));
  const auto rows = [&](const std::vector<SurfacePoint>& onSurface) {
    const Points positions = positionsOf(boundary.solid, onSurface);
    Matrix out(onSurface.size(), 1);
    for (std::size_t i = 0; i < onSurface.size(); ++i)
      out(i, 0) = conditions.isFree(onSurface[i]) ? envelope(positions[i]) : certified.values;
    return out;
  };
  AdaptiveSettings coarse;
  coarse.tolerance = kOfComparison;
  coarse.maxSources = kMostOfComparison;
  coarse.outlierRounds = 0;
  const AdaptiveProblem problem =
      adaptiveProblem(boundary.solid, rows, largest, problemSettings(conditions, settings));
  const AdaptiveResult fit = fitToTolerance(problem, coarse);
  const Matrix found = fit.field.evaluate(at.points, {0, false}).values;
  const double most = *std::max_element(found.data(), found.data() + found.rows());
  return std::max(certified.values, most + fit.error.p99 * largest);
}

HarmonicField withUnitSum(const HarmonicField& field) {
  const auto count = static_cast<double>(field.channels());
  const auto share = [&](Matrix m, bool affine) {
    for (std::size_t i = 0; i < m.rows(); ++i) {
      double sum = affine && i == 0 ? -1 : 0;
      for (std::size_t k = 0; k < m.columns(); ++k) sum += m(i, k);
      for (std::size_t k = 0; k < m.columns(); ++k) m(i, k) -= sum / count;
    }
    return m;
  };
  return {field.sources(), share(field.weights(), false),
          Affine{field.affine().center, share(field.affine().coefficients, true)}};
}

}  // namespace

HarmonicFit fitHarmonic(const SourceBoundary& boundary, const BoundaryConditions& conditions,
                        const HarmonicFitSettings& settings) {
  const SurfaceConditions surface(boundary, conditions);
  const AdaptiveProblem trial = problemOf(boundary, surface, 1, settings);
  const double found = spanOf(trial.draw(kFreshSamples, 0));
  const double span = found > 0 ? found : 1;
  StageSeconds seconds;
  std::vector<ValueJump> jumps;
  if (!conditions.function)
    jumps =
        CrossingLines(boundary.solid)
            .jumps([&](const auto& at) { return surface.valuesAt(at); }, settings.tolerance * span);
  const Fitted fit = timed(seconds, "fit", [&] {
    std::optional<Fitted> few;
    // Linear values have kinks at the edges.
    if (conditions.function) few = fittedByFew(boundary, surface, span, settings);
    return few ? *few : fittedWhereNeeded(boundary, surface, span, settings, jumps);
  });
  HarmonicFit out{fit.field, 0, {}, 0, false, {}, 0, 0, 0, {}, {}, {}};
  out.span = span;
  out.end = fit.end;
  out.freeShare = surface.freeShare();
  out.sources = out.field.sources().size();
  out.collocation = fit.collocation;
  timed(seconds, "certificate", [&] {
    const Certified certified = certifyField(boundary, surface, out.field, span, settings);
    out.error = certified.error;
    out.bound = surface.anyFree()
                    ? comparisonBound(boundary, surface, certified, out.field, span, settings)
                    : out.error.bound;
  });
  out.met = out.error.p99 <= settings.tolerance;
  if (const std::string text = jumpsText(jumps, span, "the values' span"); !text.empty())
    out.notes.push_back(boundary.mesh.name + ": " + text);
  if (conditions.unitSum) out.field = withUnitSum(out.field);
  out.seconds = std::move(seconds);
  return out;
}

std::vector<Setting> describe(HarmonicFitSettings& s) {
  return {toleranceSetting(&s.tolerance).in("fraction of the values' span"),
          maxSourcesSetting(&s.maxSources), seedSetting(&s.seed)};
}

}  // namespace innermap
