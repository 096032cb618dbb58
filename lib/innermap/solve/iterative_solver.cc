#include "innermap/solve/iterative_solver.h"

#include <cblas.h>
#include <lapacke.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/parallel.h"
#include "innermap/core/random.h"
#include "innermap/solve/clusters.h"
#include "innermap/solve/directions.h"
#include "innermap/solve/kernel_sum.h"

namespace innermap {
namespace {

constexpr std::size_t kAffine = 4;
constexpr std::size_t kClusterSize = 150;
constexpr double kOverlap = 4.5;          // spacings
constexpr double kLocalLambda = 1e-2;     // relative; strong: weaker ones converge worse
constexpr double kCoarseLambda = 1e-3;    // relative
constexpr std::size_t kCoarsePoints = 4;  // collocation points a coarse source
constexpr double kLeastFall = 0.97;       // of the residual; less is not worth an iteration

Points normalised(const Points& points, const Vec3& center, double scale) {
  Points out(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = (points[i] - center) / scale;
  return out;
}

Points subset(const Points& points, const std::vector<std::size_t>& indices) {
  Points out;
  out.reserve(indices.size());
  for (const std::size_t i : indices) out.push_back(points[i]);
  return out;
}

// Of columns from `firstColumn` on, over the first `rows`.
double meanSquaredNorm(const Matrix& a, std::size_t firstColumn, std::size_t rows) {
  double sum = 0;
  for (std::size_t j = firstColumn; j < a.columns(); ++j)
    for (std::size_t i = 0; i < rows; ++i) sum += a(i, j) * a(i, j);
  return sum / static_cast<double>(a.columns() - firstColumn);
}

Matrix stacked(const Matrix& top, const Matrix& bottom) {
  Matrix out(top.rows() + bottom.rows(), top.columns());
  for (std::size_t k = 0; k < top.columns(); ++k) {
    std::copy_n(top.column(k), top.rows(), out.column(k));
    std::copy_n(bottom.column(k), bottom.rows(), out.column(k) + top.rows());
  }
  return out;
}

double rms(const Matrix& residual) {
  double sum = 0;
  for (std::size_t i = 0; i < residual.rows() * residual.columns(); ++i)
    sum += residual.data()[i] * residual.data()[i];
  return std::sqrt(sum / static_cast<double>(residual.rows()));
}

}  // namespace

std::uint64_t iterativeSolverMemory(std::size_t collocation, std::size_t sources,
                                    std::size_t coarse) {
  const double ratio = static_cast<double>(collocation) / std::max<double>(1, sources);
  // A cluster of 12^2 sources sees the collocation points of about (12 + 2 * 6)^2 of them; parts
  // that stand close to one another double that.
  const double clusters = sizeof(float) * 2 * 24 * 24 * ratio * static_cast<double>(sources);
  const double coarsePart = 8.0 * (kCoarsePoints + 3) * coarse * coarse;
  const double directions = 8.0 * (collocation + sources + coarse) * 6 * 2 * 8;
  return static_cast<std::uint64_t>(clusters + coarsePart + directions);
}

IterativeSolver::IterativeSolver(const Points& collocation, const Points& sources,
                                 const Points& coarse, const IterativeSettings& settings)
    : settings_(settings), fine_(sources.size()) {
  if (!(settings.spacing > 0) || !(settings.distance > 0))
    throw SettingError("iterative solver", "spacing and distance must be positive");
  if (sources.empty() || coarse.empty())
    throw SettingError("sources", "there are none; use at least 1 of each level");
  if (collocation.size() < coarse.size() + kAffine || collocation.size() < sources.size())
    throw SettingError("collocation points", std::to_string(collocation.size()) + " for " +
                                                 std::to_string(sources.size()) +
                                                 " sources; use 2 to 4 a source");
  requireMemory("the iterative solver with " + std::to_string(sources.size()) + " sources",
                iterativeSolverMemory(collocation.size(), sources.size(), coarse.size()),
                settings.maxMemory, "use fewer sources (memory grows in proportion)");
  const Box3 box = boundingBox(collocation);
  center_ = box.center();
  scale_ = box.diagonal() > 0 ? box.diagonal() : 1;
  collocation_ = normalised(collocation, center_, scale_);
  sources_ = normalised(sources, center_, scale_);
  for (auto& indices : clusterPoints(sources_, kClusterSize))
    clusters_.push_back({std::move(indices), {}, {}});

  const SingleThreadedBlas guard;
  parallelBlocks(
      clusters_.size(), 1, [&](std::size_t c, std::size_t) { buildCluster(clusters_[c]); },
      settings.progress, "factoring clusters");

  const Points far = normalised(coarse, center_, scale_);
  buildCoarse(far);
  sources_.insert(sources_.end(), far.begin(), far.end());
}

// Regularised least squares for the coarse charges and the affine part, over rows drawn at random.
void IterativeSolver::buildCoarse(const Points& far) {
  std::vector<std::size_t> order(collocation_.size());
  std::iota(order.begin(), order.end(), 0);
  const CounterRandom random(settings_.seed, 11);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::make_pair(random.bits(a), a) < std::make_pair(random.bits(b), b);
  });
  order.resize(std::min(order.size(), kCoarsePoints * far.size() + kAffine));
  std::sort(order.begin(), order.end());
  coarseRows_ = std::move(order);
  const std::size_t rows = coarseRows_.size(), unknowns = kAffine + far.size();
  Matrix a(rows + far.size(), unknowns);
  const Points seen = subset(collocation_, coarseRows_);
  for (std::size_t i = 0; i < rows; ++i) {
    a(i, 0) = 1;
    for (std::size_t k = 0; k < 3; ++k) a(i, 1 + k) = seen[i][static_cast<int>(k)];
  }
  fillKernelMatrix(seen, far, 1, a.column(kAffine), a.rows(), settings_.progress);
  const double lambda = kCoarseLambda * std::sqrt(meanSquaredNorm(a, kAffine, rows));
  for (std::size_t j = 0; j < far.size(); ++j) a(rows + j, kAffine + j) = lambda;
  coarseQr_ = BlockedQr(std::move(a), settings_.progress);
  coarseTriangle_ = coarseQr_.upperTriangle();
}

void IterativeSolver::buildCluster(Cluster& cluster) const {
  const double h = settings_.spacing / scale_, d = settings_.distance / scale_;
  const Box3 box = boundingBox(subset(sources_, cluster.sources));
  const std::vector<std::size_t> around = pointsWithin(sources_, box, kOverlap * h);
  cluster.rows = pointsWithin(collocation_, box, kOverlap * h + std::max(h, d));
  const std::size_t n = around.size(), m = cluster.rows.size(), own = cluster.sources.size();
  if (m == 0) return;
  // Filled on this thread: clusters are what runs side by side.
  Matrix a(m, n);
  const Points rows = subset(collocation_, cluster.rows);
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = 0; i < m; ++i) a(i, j) = 1 / norm(rows[i] - sources_[around[j]]);
  Matrix g(n, n);
  cblas_dsyrk(CblasColMajor, CblasLower, CblasTrans, static_cast<int>(n), static_cast<int>(m), 1,
              a.data(), static_cast<int>(m), 0, g.data(), static_cast<int>(n));
  double trace = 0;
  for (std::size_t j = 0; j < n; ++j) trace += g(j, j);
  for (std::size_t j = 0; j < n; ++j)
    g(j, j) += kLocalLambda * kLocalLambda * trace / static_cast<double>(n);
  const lapack_int order = static_cast<lapack_int>(n);
  if (LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', order, g.data(), order) != 0)
    throw DataError(
        "solve: a cluster's matrix is singular; the points hold NaN or infinite numbers");
  Matrix unit(n, own);
  for (std::size_t k = 0; k < own; ++k) {
    const auto at = std::lower_bound(around.begin(), around.end(), cluster.sources[k]);
    unit(static_cast<std::size_t>(at - around.begin()), k) = 1;
  }
  LAPACKE_dpotrs(LAPACK_COL_MAJOR, 'L', order, static_cast<lapack_int>(own), g.data(), order,
                 unit.data(), order);
  Matrix rowsOfInverse(m, own);
  cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, static_cast<int>(m), static_cast<int>(own),
              static_cast<int>(n), 1, a.data(), static_cast<int>(m), unit.data(),
              static_cast<int>(n), 0, rowsOfInverse.data(), static_cast<int>(m));
  cluster.solve.assign(rowsOfInverse.data(), rowsOfInverse.data() + m * own);
}

IterativeSolver::Unknowns IterativeSolver::coarseCorrection(const Matrix& residual) const {
  const std::size_t rows = coarseRows_.size(), unknowns = coarseTriangle_.rows(),
                    channels = residual.columns();
  Matrix b(rows + unknowns - kAffine, channels);
  for (std::size_t k = 0; k < channels; ++k)
    for (std::size_t i = 0; i < rows; ++i) b(i, k) = residual(coarseRows_[i], k);
  coarseQr_.applyTransposedQ(b);
  const SingleThreadedBlas guard;
  cblas_dtrsm(CblasColMajor, CblasLeft, CblasUpper, CblasNoTrans, CblasNonUnit,
              static_cast<int>(unknowns), static_cast<int>(channels), 1, coarseTriangle_.data(),
              static_cast<int>(unknowns), b.data(), static_cast<int>(b.rows()));
  Unknowns out{Matrix(kAffine, channels), Matrix(sources_.size(), channels)};
  for (std::size_t k = 0; k < channels; ++k) {
    std::copy_n(b.column(k), kAffine, out.affine.column(k));
    std::copy_n(b.column(k) + kAffine, unknowns - kAffine, out.weights.column(k) + fine_);
  }
  return out;
}

IterativeSolver::Unknowns IterativeSolver::localCorrection(const Matrix& residual) const {
  const std::size_t channels = residual.columns();
  Unknowns out{Matrix(kAffine, channels), Matrix(sources_.size(), channels)};
  const SingleThreadedBlas guard;
  parallelBlocks(
      clusters_.size(), 4,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
          const Cluster& cluster = clusters_[c];
          const std::size_t m = cluster.rows.size(), own = cluster.sources.size();
          if (m == 0) continue;
          std::vector<float> seen(m * channels), weights(own * channels);
          for (std::size_t k = 0; k < channels; ++k)
            for (std::size_t i = 0; i < m; ++i)
              seen[k * m + i] = static_cast<float>(residual(cluster.rows[i], k));
          cblas_sgemm(CblasColMajor, CblasTrans, CblasNoTrans, static_cast<int>(own),
                      static_cast<int>(channels), static_cast<int>(m), 1, cluster.solve.data(),
                      static_cast<int>(m), seen.data(), static_cast<int>(m), 0, weights.data(),
                      static_cast<int>(own));
          for (std::size_t k = 0; k < channels; ++k)
            for (std::size_t j = 0; j < own; ++j)
              out.weights(cluster.sources[j], k) = weights[k * own + j];
        }
      },
      settings_.progress);
  return out;
}

// A x for charges [first, last) alone, and the affine part.
Matrix IterativeSolver::apply(const Unknowns& x, std::size_t first, std::size_t last) const {
  const std::size_t channels = x.weights.columns(), count = last - first;
  Matrix weights(count, channels);
  for (std::size_t k = 0; k < channels; ++k)
    std::copy_n(x.weights.column(k) + first, count, weights.column(k));
  const Points sources(sources_.begin() + static_cast<std::ptrdiff_t>(first),
                       sources_.begin() + static_cast<std::ptrdiff_t>(last));
  Matrix out =
      sumCharges(Charges(sources, weights), collocation_, false, settings_.progress).values;
  for (std::size_t k = 0; k < channels; ++k)
    for (std::size_t i = 0; i < out.rows(); ++i) {
      const Vec3& p = collocation_[i];
      out(i, k) +=
          x.affine(0, k) + x.affine(1, k) * p.x + x.affine(2, k) * p.y + x.affine(3, k) * p.z;
    }
  return out;
}

// Values centred and divided by `size`: the local solves are in single precision.
IterativeSolver::Scaled IterativeSolver::scaled(const Matrix& values) const {
  Scaled out{values, std::vector<double>(values.columns(), 0.0), 0};
  for (std::size_t k = 0; k < values.columns(); ++k) {
    const auto [low, high] =
        std::minmax_element(values.column(k), values.column(k) + values.rows());
    out.middle[k] = 0.5 * (*low + *high);
    out.size = std::max(out.size, *high - *low);
  }
  if (!(out.size > 0)) out.size = 1;
  for (std::size_t k = 0; k < values.columns(); ++k)
    for (std::size_t i = 0; i < values.rows(); ++i)
      out.values(i, k) = (values(i, k) - out.middle[k]) / out.size;
  return out;
}

// Back to world units.
void IterativeSolver::unscale(const Scaled& scaled, const Matrix& x, IterativeSolution& out) const {
  const std::size_t channels = x.columns();
  out.affine.center = center_;
  out.affine.coefficients = Matrix(kAffine, channels);
  out.weights = Matrix(sources_.size(), channels);
  for (std::size_t k = 0; k < channels; ++k) {
    out.affine.coefficients(0, k) = scaled.middle[k] + scaled.size * x(0, k);
    for (std::size_t r = 1; r < kAffine; ++r)
      out.affine.coefficients(r, k) = scaled.size * x(r, k) / scale_;
    for (std::size_t j = 0; j < sources_.size(); ++j) {
      out.weightNorm = std::max(out.weightNorm, std::abs(x(kAffine + j, k)));
      out.weights(j, k) = scaled.size * scale_ * x(kAffine + j, k);
    }
  }
}

IterativeSolution IterativeSolver::solve(const Matrix& values) const {
  if (values.rows() != collocation_.size())
    throw DataError("solve: the values do not fit the collocation points");
  const Scaled rhs = scaled(values);
  const std::size_t unknowns = kAffine + sources_.size();
  Matrix residual = rhs.values, x(unknowns, values.columns());
  IterativeSolution out;
  out.residuals.push_back(rhs.size * rms(residual));
  OrthogonalDirections directions(collocation_.size(), unknowns);
  for (int iteration = 0; iteration < settings_.maxIterations; ++iteration) {
    reportProgress(settings_.progress, "solving",
                   static_cast<double>(iteration) / settings_.maxIterations);
    const Unknowns coarse = coarseCorrection(residual);
    const Matrix coarseImage = apply(coarse, fine_, sources_.size());
    Matrix after = residual;
    for (std::size_t i = 0; i < after.rows() * after.columns(); ++i)
      after.data()[i] -= coarseImage.data()[i];
    const Unknowns local = localCorrection(after);
    directions.add(stacked(coarse.affine, coarse.weights), coarseImage);
    directions.add(stacked(local.affine, local.weights), apply(local, 0, fine_));
    directions.project(residual, x);
    ++out.iterations;
    out.residuals.push_back(rhs.size * rms(residual));
    if (!(out.residuals.back() < kLeastFall * out.residuals[out.residuals.size() - 2])) break;
  }
  unscale(rhs, x, out);
  return out;
}

}  // namespace innermap
