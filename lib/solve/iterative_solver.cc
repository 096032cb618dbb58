#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <string>

#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/solve/kernel_sum.h"
#include "innermap/solve/solver.h"
#include "solve/detail/affine_fit.h"
#include "solve/detail/coarse_solver.h"
#include "solve/detail/directions.h"
#include "solve/detail/local_solver.h"

namespace innermap {
namespace {

constexpr std::size_t kAffine = CoarseSolver::kAffine;
constexpr double kLeastGain = 0.03;  // of the residual; less is not worth an iteration
// An iteration's gain (in squares of the residual) is taken to be at least this share of the one
// before.
constexpr double kLeastShrinkage = 0.04;
constexpr double kFewAdded = 0.02;  // of all charges: they are solved for alone
constexpr double kFinestProduct = 1e-12, kCoarsestProduct = 1e-3;  // relative
constexpr double kSameSpacing = 1e-6;                              // relative

constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();
constexpr double kOfGradients = 0.01;  // they are so much less exact than values: see fast_sum.h

double affineValue(const Collocation& at, std::size_t i, const double* coefficients) {
  const std::array<double, kAffine> row = at.affine(i);
  return std::inner_product(row.begin(), row.end(), coefficients, 0.0);
}

// Of the rows from `first` on.
double rms(const Matrix& residual, std::size_t first = 0) {
  double sum = 0;
  for (std::size_t k = 0; k < residual.columns(); ++k)
    for (std::size_t i = first; i < residual.rows(); ++i) sum += residual(i, k) * residual(i, k);
  return std::sqrt(sum / static_cast<double>(residual.rows() - first));
}

// Whether another iteration would gain next to nothing, from the rms residuals before and after
// each.
bool littleIsLeft(const std::vector<double>& r) {
  const auto square = [&](std::size_t fromEnd) { return std::pow(r[r.size() - 1 - fromEnd], 2); };
  const double gain = square(1) - square(0);
  double shrinkage = 1;
  if (r.size() > 2)
    shrinkage = std::clamp(2 * std::sqrt(gain / (square(2) - square(1))), kLeastShrinkage, 1.0);
  return !(gain * shrinkage > 2 * kLeastGain * square(0));
}

std::size_t sourcesOf(const std::vector<SourceLevel>& levels) {
  std::size_t count = 0;
  for (const SourceLevel& level : levels) count += level.sources.size();
  return count;
}

Matrix rowsOf(const Matrix& a, std::size_t first) {
  Matrix out(a.rows() - first, a.columns());
  for (std::size_t k = 0; k < a.columns(); ++k)
    std::copy_n(a.column(k) + first, out.rows(), out.column(k));
  return out;
}

}  // namespace

std::uint64_t iterativeSolverMemory(std::size_t collocation, std::size_t sources,
                                    std::size_t coarse, bool refined) {
  const double directions = 8.0 * static_cast<double>(collocation + sources + coarse) * 6 * 2 * 8;
  return localSolverMemory(collocation, sources, refined) + coarseSolverMemory(coarse) +
         static_cast<std::uint64_t>(directions);
}

class IterativeSolver::Levels {
 public:
  Levels(const Collocation& collocation, const std::vector<SourceLevel>& levels,
         const IterativeSettings& settings);

  void add(const Collocation& collocation, const std::vector<SourceLevel>& levels);
  IterativeSolution solve(const Matrix& values, const IterativeSolution* start) const;

  const Points& sources() const { return sources_; }
  std::size_t collocation() const { return collocation_.size(); }

 private:
  struct Level {
    LocalSolver solver;
    std::vector<std::size_t> sources;  // indices into sources_
  };
  struct Scaled;

  void check(const Collocation& collocation, const std::vector<SourceLevel>& levels,
             bool first) const;
  void addPoints(const Collocation& collocation);
  std::vector<std::size_t> addSources(const Points& sources);
  void addLevel(const SourceLevel& level);
  Scaled scaled(const Matrix& values) const;
  double startFrom(const IterativeSolution& start, const Scaled& values, Matrix& residual,
                   Matrix& x) const;
  Matrix scaledStart(const IterativeSolution& start, const Scaled& values) const;
  void iterate(const Scaled& values, Matrix& residual, Matrix& x, IterativeSolution& out) const;
  void runCoarse(OrthogonalDirections& directions, Matrix& residual, Matrix& x,
                 IterativeSolution& out) const;
  void runLevels(std::size_t known, OrthogonalDirections& directions, Matrix& residual, Matrix& x,
                 IterativeSolution& out) const;
  bool settleAdded(const IterativeSolution& start, double rounding, Matrix& residual, Matrix& x,
                   IterativeSolution& out) const;
  void takeDirections(const Matrix& weights, const std::vector<std::size_t>& rows,
                      const Points& sources, OrthogonalDirections& directions, Matrix& residual,
                      Matrix& x, IterativeSolution& out) const;
  void unscale(const Scaled& values, const Matrix& residual, const Matrix& x,
               IterativeSolution& out) const;
  FieldSamples image(const Matrix& weights, const Points& sources, const Collocation& at,
                     const SumPoints& places, double accuracy) const;
  Points normalised(const Points& points) const;
  std::size_t unknowns() const { return CoarseSolver::kAffine + sources_.size(); }

  IterativeSettings settings_;
  Vec3 center_;
  double scale_ = 1;
  Collocation collocation_;          // normalised
  std::optional<SumPoints> places_;  // its points
  Points sources_;                   // world units
  Points coarseSources_;             // normalised
  std::vector<std::size_t>
      coarseRows_;  // of the affine part and the first level among the unknowns
  CoarseSolver coarse_;
  std::vector<Level> levels_;  // beyond the first, of falling spacing
};

// Values less their affine part, divided by `size`: the local solves are in single precision, and a
// part that is far larger than what is left would decide which directions are worth taking.
struct IterativeSolver::Levels::Scaled {
  Matrix values;
  Matrix affine;        // of 1, x, y, z in normalised units, 4 x #K; the values' own units
  double size = 0;      // of the widest channel
  double rounding = 0;  // of the values
};

IterativeSolver::Levels::Levels(const Collocation& collocation,
                                const std::vector<SourceLevel>& levels,
                                const IterativeSettings& settings)
    : settings_(settings) {
  check(collocation, levels, true);
  const Box3 box = boundingBox(collocation.points);
  center_ = box.center();
  scale_ = box.diagonal() > 0 ? box.diagonal() : 1;
  addPoints(collocation);
  coarseSources_ = normalised(levels.front().sources);
  coarseRows_.resize(kAffine);
  std::iota(coarseRows_.begin(), coarseRows_.end(), 0);
  for (const std::size_t i : addSources(levels.front().sources)) coarseRows_.push_back(kAffine + i);
  coarse_ = CoarseSolver(collocation_, coarseSources_, settings_.seed);
  for (std::size_t l = 1; l < levels.size(); ++l) addLevel(levels[l]);
}

void IterativeSolver::Levels::add(const Collocation& collocation,
                                  const std::vector<SourceLevel>& levels) {
  check(collocation, levels, false);
  addPoints(collocation);
  for (const SourceLevel& level : levels) addLevel(level);
}

void IterativeSolver::Levels::check(const Collocation& collocation,
                                    const std::vector<SourceLevel>& levels, bool first) const {
  if (first && levels.empty())
    throw SettingError("charges", "there are none; use at least one level of them");
  requireNumber("accuracy", settings_.accuracy, {kFinestProduct, kCoarsestProduct});
  for (const SourceLevel& level : levels) {
    if (!(level.spacing > 0) || !(level.distance > 0))
      throw SettingError("iterative solver", "spacing and distance must be positive");
    if (level.sources.empty())
      throw SettingError("charges", "there are none; use at least 1 of each level");
  }
  const std::size_t points = collocation_.size() + collocation.size(),
                    sources = sources_.size() + sourcesOf(levels),
                    coarse = first ? levels.front().sources.size() : coarseSources_.size();
  if (points < coarse + kAffine || points < sources)
    throw SettingError("collocation points", std::to_string(points) + " for " +
                                                 std::to_string(sources) +
                                                 " sources; use 2 to 4 a source");
  requireMemory("the iterative solver with " + std::to_string(sources) + " sources",
                iterativeSolverMemory(points, sources - coarse, coarse),
                "use fewer charges (memory grows in proportion)");
}

Points IterativeSolver::Levels::normalised(const Points& points) const {
  Points out(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = (points[i] - center_) / scale_;
  return out;
}

void IterativeSolver::Levels::addPoints(const Collocation& collocation) {
  collocation_.append(collocation.normalised(center_, scale_));
  places_.emplace(collocation_.points);
}

std::vector<std::size_t> IterativeSolver::Levels::addSources(const Points& sources) {
  std::vector<std::size_t> indices(sources.size());
  std::iota(indices.begin(), indices.end(), sources_.size());
  sources_.insert(sources_.end(), sources.begin(), sources.end());
  return indices;
}

void IterativeSolver::Levels::addLevel(const SourceLevel& level) {
  const double spacing = level.spacing / scale_;
  auto at = std::find_if(levels_.begin(), levels_.end(), [&](const Level& l) {
    return l.solver.spacing() <= spacing * (1 + kSameSpacing);
  });
  if (at == levels_.end() || at->solver.spacing() < spacing * (1 - kSameSpacing))
    at = levels_.insert(at, Level{LocalSolver(spacing, level.distance / scale_), {}});
  at->solver.add(normalised(level.sources), collocation_);
  const std::vector<std::size_t> added = addSources(level.sources);
  at->sources.insert(at->sources.end(), added.begin(), added.end());
}

IterativeSolver::Levels::Scaled IterativeSolver::Levels::scaled(const Matrix& values) const {
  if (values.rows() != collocation_.size())
    throw DataError("solve: the values do not fit the collocation points");
  Scaled out;
  out.values = values;
  std::vector<double> middle(values.columns(), 0.0);
  double largest = 0;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < values.columns(); ++k) {
    double low = kInfinity, high = -kInfinity;
    for (std::size_t i = 0; i < values.rows(); ++i) {
      largest = std::max(largest, std::abs(values(i, k)));
      if (collocation_.derivative(i)) {
        out.size = std::max(out.size, std::abs(values(i, k)));
        continue;
      }
      low = std::min(low, values(i, k));
      high = std::max(high, values(i, k));
    }
    if (low > high) continue;
    middle[k] = 0.5 * (low + high);
    out.size = std::max(out.size, high - low);
    for (std::size_t i = 0; i < values.rows(); ++i)
      if (!collocation_.derivative(i)) out.values(i, k) -= middle[k];
  }
  if (!(out.size > 0)) out.size = 1;
  out.affine = fitAffine(collocation_, out.values);
  for (std::size_t k = 0; k < values.columns(); ++k) {
    for (std::size_t i = 0; i < values.rows(); ++i)
      out.values(i, k) =
          (out.values(i, k) - affineValue(collocation_, i, out.affine.column(k))) / out.size;
    out.affine(0, k) += middle[k];
  }
  out.rounding = kRounding * largest / out.size;
  return out;
}

// An earlier solution as unknowns for the scaled values.
Matrix IterativeSolver::Levels::scaledStart(const IterativeSolution& start,
                                            const Scaled& values) const {
  const std::size_t channels = values.values.columns();
  if (start.weights.rows() > sources_.size() || start.residual.rows() > collocation_.size() ||
      start.residual.columns() != channels || start.weights.columns() != channels ||
      start.affine.coefficients.columns() != channels)
    throw DataError("solve: the solution to start from does not fit the sources and values");
  Matrix x(unknowns(), channels);
  for (std::size_t k = 0; k < channels; ++k) {
    const Vec3& c = start.affine.center;
    const Vec3 shift = center_ - c;
    double middle = start.affine.coefficients(0, k);
    for (std::size_t a = 0; a < 3; ++a) {
      const double slope = start.affine.coefficients(1 + a, k);
      middle += slope * shift[static_cast<int>(a)];
      x(1 + a, k) = (slope * scale_ - values.affine(1 + a, k)) / values.size;
    }
    x(0, k) = (middle - values.affine(0, k)) / values.size;
    for (std::size_t j = 0; j < start.weights.rows(); ++j)
      x(kAffine + j, k) = start.weights(j, k) / (values.size * scale_);
  }
  return x;
}

// Back to world units.
void IterativeSolver::Levels::unscale(const Scaled& values, const Matrix& residual, const Matrix& x,
                                      IterativeSolution& out) const {
  out.residual = residual;
  for (std::size_t i = 0; i < residual.rows() * residual.columns(); ++i)
    out.residual.data()[i] *= values.size;
  const std::size_t channels = x.columns();
  out.affine.center = center_;
  out.affine.coefficients = Matrix(kAffine, channels);
  out.weights = Matrix(sources_.size(), channels);
  for (std::size_t k = 0; k < channels; ++k) {
    for (std::size_t r = 0; r < kAffine; ++r)
      out.affine.coefficients(r, k) =
          (values.affine(r, k) + values.size * x(r, k)) / (r == 0 ? 1 : scale_);
    for (std::size_t j = 0; j < sources_.size(); ++j) {
      out.weightNorm = std::max(out.weightNorm, std::abs(x(kAffine + j, k)));
      out.weights(j, k) = values.size * scale_ * x(kAffine + j, k);
    }
  }
}

// What the charges' weights give at the points, which `places` has too, to a relative accuracy; all
// in normalised units.
FieldSamples IterativeSolver::Levels::image(const Matrix& weights, const Points& sources,
                                            const Collocation& at, const SumPoints& places,
                                            double accuracy) const {
  FastSumSettings s;
  s.accuracy = std::clamp(accuracy, kFinestProduct, kCoarsestProduct);
  const FastSum sum(sources, weights);
  FieldSamples out = sum.at(places, s);
  const std::vector<std::size_t> rows = derivativeRows(at);
  if (!rows.empty()) {
    s.accuracy = std::max(kFinestProduct, kOfGradients * s.accuracy);
    s.gradients = true;
    out.values = rowValues(at, std::move(out.values), sum.at(at.subset(rows).points, s).gradients);
  }
  // A channel's values are at most so much larger than all.
  const double asked = s.accuracy * std::sqrt(static_cast<double>(weights.columns()));
  if (out.error <= asked * rms(out.values)) out.error = 0;
  return out;
}

// Adds `weights`, those of the unknowns `rows`, as directions, and follows them. `rows` starts with
// the affine part when there are four more of them than of sources.
void IterativeSolver::Levels::takeDirections(const Matrix& weights,
                                             const std::vector<std::size_t>& rows,
                                             const Points& sources,
                                             OrthogonalDirections& directions, Matrix& residual,
                                             Matrix& x, IterativeSolution& out) const {
  const std::size_t affine = rows.size() - sources.size();
  FieldSamples sums = image(rowsOf(weights, affine), sources, collocation_, *places_,
                            settings_.accuracy / rms(residual));
  out.productError = std::max(out.productError, sums.error);
  Matrix& images = sums.values;
  Matrix z(unknowns(), weights.columns());
  for (std::size_t k = 0; k < z.columns(); ++k) {
    for (std::size_t i = 0; i < rows.size(); ++i) z(rows[i], k) = weights(i, k);
    for (std::size_t i = 0; i < images.rows() && affine > 0; ++i)
      images(i, k) += affineValue(collocation_, i, z.column(k));
  }
  const std::size_t first = directions.count();
  directions.add(std::move(z), std::move(images));
  directions.project(first, residual, x);
}

void IterativeSolver::Levels::runCoarse(OrthogonalDirections& directions, Matrix& residual,
                                        Matrix& x, IterativeSolution& out) const {
  takeDirections(coarse_.correction(residual), coarseRows_, coarseSources_, directions, residual, x,
                 out);
}

// Of each level the charges beyond the `known` ones.
void IterativeSolver::Levels::runLevels(std::size_t known, OrthogonalDirections& directions,
                                        Matrix& residual, Matrix& x, IterativeSolution& out) const {
  for (const Level& level : levels_) {
    const auto added = std::lower_bound(level.sources.begin(), level.sources.end(), known);
    if (added == level.sources.end()) continue;
    const auto first = static_cast<std::size_t>(added - level.sources.begin());
    std::vector<std::size_t> rows(added, level.sources.end());
    for (std::size_t& i : rows) i += kAffine;
    const Points& all = level.solver.sources();
    const Points sources(all.begin() + static_cast<std::ptrdiff_t>(first), all.end());
    takeDirections(level.solver.correction(residual, first), rows, sources, directions, residual, x,
                   out);
  }
}

// Solves for what was added to an earlier solution by itself, for the other charges fit the points
// that they had as well as they can. Whether that is all there is to do.
bool IterativeSolver::Levels::settleAdded(const IterativeSolution& start, double rounding,
                                          Matrix& residual, Matrix& x,
                                          IterativeSolution& out) const {
  const std::size_t known = start.weights.rows(), seen = start.residual.rows();
  if (known == sources_.size() || seen == residual.rows() || !(rms(residual) > rounding))
    return false;
  OrthogonalDirections directions(collocation_.size(), unknowns());
  std::vector<double> there{rms(residual, seen)};
  do {
    runLevels(known, directions, residual, x, out);
    there.push_back(rms(residual, seen));
  } while (!littleIsLeft(there) && static_cast<int>(there.size()) <= settings_.maxIterations &&
           !outOfTime());
  const auto all = static_cast<double>(sources_.size());
  return all - static_cast<double>(known) <= kFewAdded * all;
}

void IterativeSolver::Levels::iterate(const Scaled& values, Matrix& residual, Matrix& x,
                                      IterativeSolution& out) const {
  OrthogonalDirections directions(collocation_.size(), unknowns());
  bool left = rms(residual) > values.rounding;
  while (left && out.iterations < settings_.maxIterations) {
    reportProgress("solving", static_cast<double>(out.iterations) / settings_.maxIterations);
    runCoarse(directions, residual, x, out);
    runLevels(0, directions, residual, x, out);
    ++out.iterations;
    out.residuals.push_back(values.size * rms(residual));
    left = !littleIsLeft(out.residuals) && !outOfTime();
  }
}

// The unknowns of an earlier solution, and its residual: known where it was solved for.
double IterativeSolver::Levels::startFrom(const IterativeSolution& start, const Scaled& values,
                                          Matrix& residual, Matrix& x) const {
  x = scaledStart(start, values);
  const std::size_t known = start.residual.rows();
  std::vector<std::size_t> added(collocation_.size() - known);
  std::iota(added.begin(), added.end(), known);
  const Collocation fresh = collocation_.subset(added);
  const FieldSamples image = this->image(rowsOf(x, kAffine), normalised(sources_), fresh,
                                         SumPoints(fresh.points), settings_.accuracy);
  const Matrix& sums = image.values;
  for (std::size_t k = 0; k < residual.columns(); ++k) {
    for (std::size_t i = 0; i < known; ++i) residual(i, k) = start.residual(i, k) / values.size;
    for (std::size_t i = 0; i < fresh.size(); ++i)
      residual(known + i, k) -= sums(i, k) + affineValue(fresh, i, x.column(k));
  }
  return image.error;
}

IterativeSolution IterativeSolver::Levels::solve(const Matrix& values,
                                                 const IterativeSolution* start) const {
  const Scaled rhs = scaled(values);
  Matrix residual = rhs.values, x(unknowns(), values.columns());
  IterativeSolution out;
  if (start) out.productError = startFrom(*start, rhs, residual, x);
  out.residuals.push_back(rhs.size * rms(residual));
  if (start && settleAdded(*start, rhs.rounding, residual, x, out)) {
    ++out.iterations;
    out.residuals.push_back(rhs.size * rms(residual));
  } else {
    iterate(rhs, residual, x, out);
  }
  unscale(rhs, residual, x, out);
  return out;
}

IterativeSolver::IterativeSolver(const Collocation& collocation,
                                 const std::vector<SourceLevel>& levels,
                                 const IterativeSettings& settings)
    : levels_(std::make_unique<Levels>(collocation, levels, settings)) {}
IterativeSolver::IterativeSolver(IterativeSolver&&) noexcept = default;
IterativeSolver& IterativeSolver::operator=(IterativeSolver&&) noexcept = default;
IterativeSolver::~IterativeSolver() = default;

void IterativeSolver::add(const Collocation& collocation, const std::vector<SourceLevel>& levels) {
  levels_->add(collocation, levels);
}

IterativeSolution IterativeSolver::solve(const Matrix& values,
                                         const IterativeSolution* start) const {
  return levels_->solve(values, start);
}

const Points& IterativeSolver::sources() const { return levels_->sources(); }
std::size_t IterativeSolver::collocation() const { return levels_->collocation(); }

}  // namespace innermap
