#include "frame_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "innermap/field/fit.h"
#include "innermap/mesh/read.h"
#include "innermap/sample/source_points.h"
#include "innermap/sample/surface_samples.h"

namespace innermap::tool {
namespace {

constexpr double kDistance = 1.25;  // spacings
constexpr double kFarthest = 4;     // spacings, of charges beyond the first level
constexpr double kProducts = 1e-6;  // accuracy; a hundredth of what the fits leave
constexpr std::size_t kFreshSamples = 20000;
// Seeds of the random sets, so that none has a point of another.
enum Stream : std::uint64_t { kCollocation = 0, kFresh = 2, kSources = 3 };

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
std::vector<SourceLevel> levelsOf(const Solid& solid, const FrameOptions& options,
                                  Progress* progress) {
  const auto spacing = [&](std::size_t count) {
    return std::sqrt(solid.area() / static_cast<double>(count));
  };
  const bool many = options.sources > kMostDenseSources;
  const double near = options.distance ? *options.distance * solid.diagonal()
                                       : kDistance * spacing(options.sources);
  if (many && near > kFarthest * spacing(options.sources))
    throw SettingError(
        "--distance",
        fmt::format("is over 4 spacings of {} charges; use at most {:.3g}, or at most {} --sources",
                    options.sources, kFarthest * spacing(options.sources) / solid.diagonal(),
                    kMostDenseSources));
  SourceSettings settings;
  settings.seed = 4 * options.seed + kSources;
  settings.progress = progress;
  std::vector<SourceLevel> levels;
  if (many) {
    const std::size_t coarse = std::clamp<std::size_t>(options.sources / 8, 300, 2500);
    levels.push_back(shell(solid, coarse, std::max(near, kDistance * spacing(coarse)), settings));
  }
  levels.push_back(shell(solid, options.sources, near, settings));
  return levels;
}

}  // namespace

FrameSolver::FrameSolver(const std::string& rest, const FrameOptions& options, Context& context) {
  context.timed("read", [&] { rest_ = readMesh(rest, {context.progress()}); });
  solid_.emplace(makeSourceSolid(rest_, context));
  std::vector<SourceLevel> levels;
  context.timed("sample", [&] {
    SampleSettings settings;
    settings.progress = context.progress();
    settings.seed = 4 * options.seed + kCollocation;
    collocation_ = samplesAt(blueNoiseSamples(solid_->surface(), collocationOf(options), settings));
    settings.seed = 4 * options.seed + kFresh;
    fresh_ = samplesAt(randomSamples(solid_->surface(), kFreshSamples, settings));
    levels = levelsOf(*solid_, options, context.progress());
  });
  context.timed("factor", [&] {
    IterativeSettings settings;
    settings.accuracy = kProducts;
    settings.maxMemory = context.maxMemory();
    settings.progress = context.progress();
    solver_.emplace(collocation_.points, levels, settings);
  });
  ReportSolve solve;
  solve.method = levels.size() > 1 ? "iterative" : "dense";
  solve.sources = solve.rank = solver_->sources().size();
  solve.collocation = collocation_.points.size();
  Report& report = context.report();
  report.solve = solve;
  report.set("solve.placement", std::string("shell"));
  report.set("solve.distance", levels.back().distance / solid_->diagonal());
  report.set("solve.seed", static_cast<std::int64_t>(options.seed));
}

FrameSolver::Samples FrameSolver::samplesAt(const std::vector<SurfacePoint>& onSurface) const {
  Samples out;
  out.points = interpolate(solid_->surface().vertices, solid_->surface().triangles, onSurface);
  out.addresses.reserve(onSurface.size());
  for (const SurfacePoint& p : onSurface) out.addresses.push_back(solid_->address(p));
  return out;
}

Matrix FrameSolver::valuesAt(const Samples& samples, const TargetBoundary& boundary) const {
  const Points points =
      interpolate(boundary.moved, solid_->repaired().mesh.triangles, samples.addresses);
  Matrix values(points.size(), 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int a = 0; a < 3; ++a) values(i, static_cast<std::size_t>(a)) = points[i][a];
  return values;
}

FrameFit FrameSolver::solve(const FrameFile& frame, Context& context) const {
  Mesh mesh;
  context.timed("read", [&] { mesh = readMeshLike(frame.path, rest_, {context.progress()}); });
  TargetBoundary boundary = makeTargetBoundary(*solid_, mesh, context);
  IterativeSolution solution;
  context.timed("solve", [&] { solution = solver_->solve(valuesAt(collocation_, boundary)); });
  HarmonicField field(solver_->sources(), std::move(solution.weights), std::move(solution.affine));
  BoundaryError error;
  context.timed("certificate", [&] {
    // By fast sums, to a hundredth of what is measured.
    const double accuracy = std::max(1e-2 * solution.residuals.back(), 1e-12 * boundary.diagonal);
    error = summarizeErrors(boundaryErrors(field, fresh_.points, valuesAt(fresh_, boundary),
                                           boundary.diagonal, {accuracy, context.progress()}));
  });
  if (error.max > 0.1)
    context.warning(
        fmt::format("frame {}: the boundary error reaches {:.2g} of the diagonal: this "
                    "map is not to be trusted; use more --sources",
                    frame.number, error.max));
  return {std::move(boundary), std::move(field), error, solution.iterations};
}

HarmonicField FrameSolver::combined(
    const std::vector<std::pair<const FrameFit*, double>>& fits) const {
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

}  // namespace innermap::tool
