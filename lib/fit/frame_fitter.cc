#include "innermap/fit/frame_fitter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fit/detail/boundary_check.h"
#include "fit/detail/inside_check.h"
#include "fit/detail/problem_samples.h"
#include "fit/detail/solid_proof.h"
#include "fit/detail/streams.h"
#include "fit/detail/value_jumps.h"
#include "fit/tangle.h"
#include "innermap/core/error.h"
#include "innermap/field/fit.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/fit/surface_problem.h"
#include "sample/source_points.h"
#include "sample/surface_samples.h"

namespace innermap {
namespace {

constexpr std::size_t kFramePointsPerSource = 3;
constexpr double kDistance = 1.25;     // spacings
constexpr double kFarthest = 4;        // spacings, of charges beyond the first level
constexpr double kProducts = 1e-6;     // accuracy; a hundredth of what the fits leave
constexpr std::size_t kInside = 4000;  // points at which folds are looked for
constexpr double kSumAccuracy = 1e-6;  // of the frame's diagonal, of these
constexpr std::size_t kKept = 3;       // frames before the one asked for

SourceLevel shell(const Solid& solid, std::size_t count, double distance, SourceSettings settings) {
  SourceLevel level;
  level.spacing = std::sqrt(solid.area() / static_cast<double>(count));
  const double fraction = std::clamp(distance / solid.diagonal(), 1e-4, 2.0);
  level.distance = fraction * solid.diagonal();
  settings.count = count;
  level.sources = sourceShell(solid, fraction, settings);
  return level;
}

// One dense level for few charges, a coarse and a fine one for many.
std::vector<SourceLevel> levelsOf(const Solid& solid, const FrameFitterSettings& settings) {
  const auto spacing = [&](std::size_t count) {
    return std::sqrt(solid.area() / static_cast<double>(count));
  };
  const bool many = settings.sources > kMostDenseSources;
  const double near = settings.distance ? *settings.distance * solid.diagonal()
                                        : kDistance * spacing(settings.sources);
  if (many && near > kFarthest * spacing(settings.sources))
    throw SettingError(
        "distance",
        fmt::format("is over 4 spacings of {} charges; use at most {:.3g}, or at most {} sources",
                    settings.sources, kFarthest * spacing(settings.sources) / solid.diagonal(),
                    kMostDenseSources));
  SourceSettings source;
  source.seed = seedOf(settings.seed, Stream::sources);
  std::vector<SourceLevel> levels;
  if (many) {
    const std::size_t coarse = std::clamp<std::size_t>(settings.sources / 8, 300, 2500);
    levels.push_back(shell(solid, coarse, std::max(near, kDistance * spacing(coarse)), source));
  }
  levels.push_back(shell(solid, settings.sources, near, source));
  return levels;
}

// Sum of the fits' fields, each times its factor.
HarmonicField combined(const std::vector<std::pair<const FrameFit*, double>>& fits) {
  const HarmonicField& first = fits.front().first->field;
  Matrix weights(first.weights().rows(), first.channels());
  Affine affine{first.affine().center, Matrix(4, first.channels())};
  const auto add = [](Matrix& to, const Matrix& from, double factor) {
    for (std::size_t i = 0; i < to.rows() * to.columns(); ++i)
      to.data()[i] += factor * from.data()[i];
  };
  for (const auto& [fit, factor] : fits) {
    add(weights, fit->field.weights(), factor);
    add(affine.coefficients, fit->field.affine().coefficients, factor);
  }
  return HarmonicField(first.sources(), std::move(weights), std::move(affine));
}

}  // namespace

std::size_t frameCollocation(const FrameFitterSettings& settings) {
  if (settings.collocation > 0) return settings.collocation;
  return std::max(kFramePointsPerSource * settings.sources, settings.sources + 8);
}

std::uint64_t frameFitterMemory(const FrameFitterSettings& settings, std::uint64_t others) {
  const std::uint64_t points = frameCollocation(settings), n = settings.sources;
  const FitSolver solver =
      settings.sources > kMostDenseSources ? FitSolver::iterative : FitSolver::dense;
  const std::uint64_t solving = fitMemory(points, n, 0, solver);
  // Of a dense solver the factors Q, U and V stay; the rest is given back before the first frame.
  const std::uint64_t stays = solver == FitSolver::dense ? 8 * n * (points + 2 * n + 100) : solving;
  // Blue noise thins five candidates a point; each costs some 100 bytes.
  return std::max(solving, stays + others) + 500 * (points + n);
}

FrameFitter::FrameFitter(SourceBoundary rest, const FrameFitterSettings& settings)
    : rest_(std::move(rest)), settings_(settings) {
  std::vector<SourceLevel> levels = timed(seconds_, "sample", [&] {
    SampleSettings sample;
    sample.seed = seedOf(settings.seed, Stream::collocation);
    collocation_ =
        samplesAt(blueNoiseSamples(solid().surface(), frameCollocation(settings), sample));
    inside_ = pointsInside(solid(), kInside);
    lines_ = std::make_shared<const CrossingLines>(solid());
    return levelsOf(solid(), settings);
  });
  levels_ = levels.size();
  distance_ = levels.back().distance / solid().diagonal();
  timed(seconds_, "factor", [&] {
    IterativeSettings solving;
    solving.accuracy = kProducts;
    solver_.emplace(collocation_.points, levels, solving);
  });
}

FrameFitter::Samples FrameFitter::samplesAt(std::vector<SurfacePoint> onSurface) const {
  Samples out;
  out.points = positionsOf(solid(), onSurface);
  out.onSurface = std::move(onSurface);
  return out;
}

FrameSolution FrameFitter::solve(const Mesh& frame) const {
  TargetBoundary boundary = makeTargetBoundary(solid(), frame);
  StageSeconds seconds = boundary.seconds;
  IterativeSolution solution = timed(seconds, "solve", [&] {
    return solver_->solve(boundary.targetsOf(solid(), collocation_.onSurface));
  });
  return {
      std::move(boundary),
      HarmonicField(solver_->sources(), std::move(solution.weights), std::move(solution.affine)),
      solution.iterations, solution.residuals.back(), std::move(seconds)};
}

FrameFit FrameFitter::fit(const Mesh& frame) const {
  FrameSolution solution = solve(frame);
  TargetBoundary& boundary = solution.boundary;
  HarmonicField& field = solution.field;
  StageSeconds& seconds = solution.seconds;
  const BoundaryError error = timed(seconds, "certificate", [&] {
    BoundaryErrorSettings e;
    // By fast sums, to a hundredth of what is measured.
    e.accuracy = std::max(1e-2 * solution.residual, 1e-12 * boundary.diagonal);
    CertificateSettings certificate;
    certificate.seed = settings_.seed;
    return certify(
        solid(),
        [&](const std::vector<SurfacePoint>& places) {
          return boundaryErrors(field, positionsOf(solid(), places),
                                boundary.targetsOf(solid(), places), boundary.diagonal, e);
        },
        certificate);
  });
  std::vector<std::string> warnings = boundary.warnings;
  if (error.max > kDoubtfulError)
    warnings.push_back(
        fmt::format("the boundary error reaches {:.2g} of the diagonal: do not trust this map; use "
                    "more charges",
                    error.max));
  std::string jumps =
      jumpsText(lines_->jumps(solid(), boundary.moved, kLeastJumpTold * boundary.diagonal),
                boundary.diagonal, "the diagonal");
  FrameFit out{
      std::move(boundary), std::move(field),  error, {}, solution.iterations, std::move(jumps),
      std::move(warnings), std::move(seconds)};
  examine(frame, out);
  return out;
}

BoundaryPair FrameFitter::pairOf(const Mesh& frame, const TargetBoundary& boundary) const {
  return {rest_, frame, checkCrossings(frame), boundary, {}, {}, {}};
}

void FrameFitter::examine(const Mesh& frame, FrameFit& fit) const {
  const ComposedMap map = HarmonicMap(fit.field);
  Injectivity& known = fit.injectivity;
  std::optional<BoundaryPair> pair;
  if (settings_.prove != Prove::off)
    timed(fit.seconds, "check", [&] {
      pair.emplace(pairOf(frame, fit.boundary));
      known = injectivityOf(*pair);
    });
  const double diagonal = fit.boundary.diagonal;
  timed(fit.seconds, "inside", [&] {
    const MappedPoints mapped = mapPoints(map, inside_, kSumAccuracy * diagonal);
    const TargetShape target = pair ? TargetShape(*pair) : TargetShape(solid(), fit.boundary);
    known.mirrored = target.orientation() < 0;
    known.inside = determinantsOf(mapped, target, fit.error.p99 * diagonal);
    known.outside = outsideShare(mapped.points, target, fit.error.p99 * diagonal);
    if (pair) checkBoundary(map, *pair, target, fit.error.p99, settings_.seed, known);
  });
  if (pair)
    timed(fit.seconds, "proof", [&] {
      known.proof = tryProof(map, *pair, settings_.prove, settings_.proofCells, fit.warnings);
    });
}

double FrameFit::folded() const {
  const DeterminantFigures& inside = injectivity.inside;
  return inside.checked > 0
             ? static_cast<double>(inside.folded) / static_cast<double>(inside.checked)
             : 0;
}

HarmonicField velocityAt(const NumberedFit& frame, const std::optional<NumberedFit>& before,
                         const std::optional<NumberedFit>& after, double framesPerSecond) {
  const auto seconds = [&](const NumberedFit& from, const NumberedFit& to) {
    return static_cast<double>(to.number - from.number) / framesPerSecond;
  };
  if (!before && !after) throw DataError("a frame has no other to take its velocity from");
  if (!before || !after) {
    const NumberedFit& other = before ? *before : *after;
    const double t = seconds(frame, other);
    return combined({{other.fit, 1 / t}, {frame.fit, -1 / t}});
  }
  const double a = seconds(*before, frame), b = seconds(frame, *after);
  return combined({{after->fit, a / (b * (a + b))},
                   {frame.fit, (b - a) / (a * b)},
                   {before->fit, -b / (a * (a + b))}});
}

FrameFits::FrameFits(std::vector<std::int64_t> numbers, std::function<FrameFit(std::size_t)> make)
    : numbers_(std::move(numbers)), make_(std::move(make)) {}

std::shared_ptr<const FrameFit> FrameFits::at(std::size_t index) {
  while (!kept_.empty() && kept_.begin()->first + kKept < index) kept_.erase(kept_.begin());
  const auto known = kept_.find(index);
  if (known != kept_.end() && known->second) return known->second;
  kept_[index] = nullptr;
  return kept_[index] = std::make_shared<const FrameFit>(make_(index));
}

std::shared_ptr<const FrameFit> FrameFits::tryAt(std::size_t index) {
  const auto known = kept_.find(index);
  if (known != kept_.end()) return known->second;
  std::shared_ptr<const FrameFit> fit;
  try {
    fit = std::make_shared<const FrameFit>(make_(index));
  } catch (const FileError&) {
  } catch (const DataError&) {
  }
  return kept_[index] = fit;
}

std::optional<NumberedFit> FrameFits::neighbour(std::size_t index, int step) {
  const auto count = static_cast<std::ptrdiff_t>(numbers_.size());
  for (std::ptrdiff_t i = static_cast<std::ptrdiff_t>(index) + step; i >= 0 && i < count;
       i += step) {
    const auto place = static_cast<std::size_t>(i);
    if (const auto fit = tryAt(place)) return NumberedFit{fit.get(), numbers_[place]};
  }
  return {};
}

HarmonicField FrameFits::velocity(std::size_t index, double framesPerSecond) {
  const std::shared_ptr<const FrameFit> here = at(index);
  return velocityAt({here.get(), numbers_[index]}, neighbour(index, -1), neighbour(index, 1),
                    framesPerSecond);
}

std::vector<Setting> describe(FrameFitterSettings& s) {
  return {Setting("charges", "N", &s.sources, "charges, the same for all frames")
              .from(1, kMaxCharges)
              .was("sources")
              .rare(),
          Setting("collocation", "N", &s.collocation, "boundary points to fit each frame to")
              .from(8, 1e7)
              .otherwise(0, "3 a charge")
              .rare(),
          Setting("distance", "D", &s.distance, "distance of the charges from the surface")
              .in("fraction of the rest pose's diagonal")
              .from(1e-4, 2)
              .otherwise("1.25 spacings of the charges")
              .rare(),
          seedSetting(&s.seed)};
}

}  // namespace innermap
