#include <cblas.h>
#include <lapacke.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/solve/kernel_sum.h"
#include "innermap/solve/solver.h"
#include "solve/detail/affine_fit.h"
#include "solve/detail/blocked_qr.h"
#include "solve/lapack_status.h"

namespace innermap {
namespace {

Points normalised(const Points& points, const Vec3& center, double scale) {
  Points out(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = (points[i] - center) / scale;
  return out;
}

double filterFactor(Regularization method, double sigma, double threshold) {
  if (sigma <= 0) return 0;
  if (method == Regularization::truncatedSvd) return sigma > threshold ? 1 : 0;
  return sigma * sigma / (sigma * sigma + threshold * threshold);
}

double span(const Matrix& values) {
  double widest = 0;
  for (std::size_t k = 0; k < values.columns(); ++k) {
    const auto [low, high] =
        std::minmax_element(values.column(k), values.column(k) + values.rows());
    widest = std::max(widest, *high - *low);
  }
  return widest;
}

double largestMagnitude(const Matrix& values) {
  double largest = 0;
  for (std::size_t i = 0; i < values.rows() * values.columns(); ++i)
    largest = std::max(largest, std::abs(values.data()[i]));
  return largest;
}

void svd(Matrix& r, Matrix& s, Matrix& u, Matrix& vt) {
  const lapack_int n = static_cast<lapack_int>(r.rows());
  s = Matrix(r.rows(), 1);
  u = Matrix(r.rows(), r.rows());
  vt = Matrix(r.rows(), r.rows());
  const SingleThreadedBlas guard;
  if (!lapackSucceeded(LAPACKE_dgesdd(LAPACK_COL_MAJOR, 'S', n, n, r.data(), n, s.data(), u.data(),
                                      n, vt.data(), n)))
    throw DataError(
        "solve: the singular value decomposition did not converge; the points hold NaN or "
        "infinite numbers");
}

}  // namespace

std::uint64_t denseSolverMemory(std::size_t collocation, std::size_t sources, std::size_t heldOut) {
  const std::uint64_t m = collocation, n = sources, h = heldOut;
  // The matrix; R22, U, V^T and 4 n^2 of workspace, of which U^T takes the place; held-out modes.
  return 8 * (m * (n + kAffineUnknowns) + 7 * n * n + 2 * h * n + 64 * n);
}

class DenseSolver::Factors {
 public:
  Factors(const Collocation& collocation, const Points& sources, const Collocation& heldOut);

  DenseSolution solve(const Matrix& values, Regularization method, const Matrix& heldOutValues,
                      std::optional<double> regularization) const;

 private:
  struct Projected;
  Matrix factor(const Collocation& at, const Points& sources);
  void decompose(Matrix& r22);
  void prepareHeldOut(const Collocation& at, const Points& sources);
  Projected project(const Matrix& values) const;
  Matrix heldOutResidual(const Projected& rhs, const Matrix& heldOutValues) const;
  double chooseRegularization(const Projected& rhs, Regularization method, const Matrix& values,
                              const Matrix& heldOutValues) const;

  Vec3 center_;
  double scale_ = 1;
  std::size_t sources_ = 0;
  BlockedQr qr_;
  Matrix affineBlock_;      // R11, 4 x 4
  Matrix coupling_;         // R11^-1 R12, 4 x #sources
  Matrix leftTransposed_;   // U^T
  Matrix rightTransposed_;  // V^T
  Matrix singularValues_;
  Matrix heldOutAffine_;  // P at the held-out points
  Matrix heldOutModes_;   // (A - P R11^-1 R12) V at the held-out points
};

// A right-hand side in the coordinates of the factorization.
struct DenseSolver::Factors::Projected {
  Matrix affine;  // R11^-1 (Q^T b)_1, 4 x #K
  Matrix modes;   // U^T (Q^T b)_2, #sources x #K
};

DenseSolver::Factors::Factors(const Collocation& collocation, const Points& sources,
                              const Collocation& heldOut)
    : sources_(sources.size()) {
  const std::size_t m = collocation.size(), n = sources.size(), columns = n + kAffineUnknowns;
  if (n == 0) throw SettingError("charges", "there are none; use at least 1");
  if (m < columns)
    throw SettingError("collocation points", std::to_string(m) + " for " + std::to_string(n) +
                                                 " sources; use at least " +
                                                 std::to_string(columns));
  requireMemory("the dense solver with " + std::to_string(n) + " sources and " + std::to_string(m) +
                    " collocation points",
                denseSolverMemory(m, n, heldOut.size()),
                "use fewer charges (memory grows with their square)");
  const Box3 box = boundingBox(collocation.points);
  center_ = box.center();
  scale_ = box.diagonal() > 0 ? box.diagonal() : 1;

  const Points normalisedSources = normalised(sources, center_, scale_);
  Matrix r22 = factor(collocation.normalised(center_, scale_), normalisedSources);
  reportProgress("singular values", 0);
  decompose(r22);
  reportProgress("singular values", 1);
  if (heldOut.size() > 0) prepareHeldOut(heldOut.normalised(center_, scale_), normalisedSources);
}

// QR of [P A]; keeps what belongs to the affine part and gives R22.
Matrix DenseSolver::Factors::factor(const Collocation& at, const Points& sources) {
  const std::size_t m = at.size(), n = sources.size(), columns = n + kAffineUnknowns;
  Matrix a(m, columns);
  fillAffineRows(at, a.data(), m);
  fillKernelMatrix(at.points, sources, 1, a.column(kAffineUnknowns), m);
  fillDerivativeRows(at, sources, a.column(kAffineUnknowns), m);
  qr_ = BlockedQr(std::move(a));
  const Matrix r = qr_.upperTriangle();
  Matrix r22(n, n);
  affineBlock_ = Matrix(kAffineUnknowns, kAffineUnknowns);
  coupling_ = Matrix(kAffineUnknowns, n);
  for (std::size_t j = 0; j < columns; ++j)
    for (std::size_t i = 0; i <= j; ++i) {
      if (j < kAffineUnknowns)
        affineBlock_(i, j) = r(i, j);
      else if (i < kAffineUnknowns)
        coupling_(i, j - kAffineUnknowns) = r(i, j);
      else
        r22(i - kAffineUnknowns, j - kAffineUnknowns) = r(i, j);
    }
  solveAffineTriangle(affineBlock_, coupling_);
  return r22;
}

// R22 = U S V^T; the storage of R22 then holds U^T.
void DenseSolver::Factors::decompose(Matrix& r22) {
  Matrix u;
  svd(r22, singularValues_, u, rightTransposed_);
  leftTransposed_ = std::move(r22);
  for (std::size_t j = 0; j < sources_; ++j)
    for (std::size_t i = 0; i < sources_; ++i) leftTransposed_(j, i) = u(i, j);
}

void DenseSolver::Factors::prepareHeldOut(const Collocation& at, const Points& sources) {
  const std::size_t n = sources.size();
  heldOutAffine_ = Matrix(at.size(), kAffineUnknowns);
  fillAffineRows(at, heldOutAffine_.data(), at.size());
  Matrix kernel(at.size(), n), right(n, n);
  fillKernelMatrix(at.points, sources, 1, kernel.data(), at.size());
  fillDerivativeRows(at, sources, kernel.data(), at.size());
  multiply(false, -1, heldOutAffine_, coupling_, 1, kernel);
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = 0; i < n; ++i) right(i, j) = rightTransposed_(j, i);
  heldOutModes_ = Matrix(at.size(), n);
  multiply(false, 1, kernel, right, 0, heldOutModes_);
}

DenseSolver::Factors::Projected DenseSolver::Factors::project(const Matrix& values) const {
  Matrix c = values;
  qr_.applyTransposedQ(c);
  Projected out{Matrix(kAffineUnknowns, values.columns()), Matrix(sources_, values.columns())};
  Matrix tail(sources_, values.columns());
  for (std::size_t k = 0; k < values.columns(); ++k) {
    std::copy_n(c.column(k), kAffineUnknowns, out.affine.column(k));
    std::copy_n(c.column(k) + kAffineUnknowns, sources_, tail.column(k));
  }
  solveAffineTriangle(affineBlock_, out.affine);
  multiply(false, 1, leftTransposed_, tail, 0, out.modes);
  return out;
}

// What the charges have to explain at the held-out points.
Matrix DenseSolver::Factors::heldOutResidual(const Projected& rhs,
                                             const Matrix& heldOutValues) const {
  Matrix residual = heldOutValues;
  multiply(false, -1, heldOutAffine_, rhs.affine, 1, residual);
  return residual;
}

double DenseSolver::Factors::chooseRegularization(const Projected& rhs, Regularization method,
                                                  const Matrix& values,
                                                  const Matrix& heldOutValues) const {
  constexpr int kCandidates = 66;  // 1, then 10^(-k/4) down to 1e-16
  const std::size_t channels = values.columns();
  const double largest = singularValues_(0, 0);
  std::vector<double> candidates;
  for (int c = 0; c < kCandidates; ++c)
    candidates.push_back(c == 0 ? 1.0 : std::pow(10.0, -(c - 1) / 4.0));
  // All candidates at once: one matrix product.
  Matrix coefficients(sources_, kCandidates * channels);
  for (int c = 0; c < kCandidates; ++c)
    for (std::size_t k = 0; k < channels; ++k)
      for (std::size_t i = 0; i < sources_ && c > 0; ++i) {
        const double f = filterFactor(method, singularValues_(i, 0), candidates[c] * largest);
        coefficients(i, c * channels + k) = f > 0 ? f * rhs.modes(i, k) / singularValues_(i, 0) : 0;
      }
  const Matrix residual = heldOutResidual(rhs, heldOutValues);
  Matrix predicted(residual.rows(), coefficients.columns());
  multiply(false, 1, heldOutModes_, coefficients, 0, predicted);
  std::vector<double> squares(kCandidates, 0.0);
  for (int c = 0; c < kCandidates; ++c)
    for (std::size_t k = 0; k < channels; ++k)
      for (std::size_t i = 0; i < residual.rows(); ++i) {
        const double e = residual(i, k) - predicted(i, c * channels + k);
        squares[c] += e * e;
      }
  const double best = *std::min_element(squares.begin(), squares.end());
  // Below the rounding of the data itself all are alike: take the tamest.
  const double rounding = 8 * std::numeric_limits<double>::epsilon() * largestMagnitude(values);
  const double enough =
      std::max(1.02 * 1.02 * best, rounding * rounding * static_cast<double>(residual.rows()));
  for (int c = 0; c < kCandidates; ++c)
    if (squares[c] <= enough) return candidates[c];
  return candidates.back();
}

DenseSolution DenseSolver::Factors::solve(const Matrix& values, Regularization method,
                                          const Matrix& heldOutValues,
                                          std::optional<double> regularization) const {
  if (regularization) requireNumber("regularization", *regularization, {0, 1});
  if (!regularization && (heldOutModes_.empty() || heldOutValues.empty()))
    throw SettingError("regularization", "give one, or held-out points to choose it by");
  const Projected rhs = project(values);
  DenseSolution out;
  out.regularization =
      regularization ? *regularization : chooseRegularization(rhs, method, values, heldOutValues);
  const std::size_t channels = values.columns();
  const double threshold = out.regularization * singularValues_(0, 0);
  const bool none = out.regularization >= 1;

  Matrix filtered(sources_, channels);
  for (std::size_t i = 0; i < sources_ && !none; ++i) {
    const double sigma = singularValues_(i, 0), f = filterFactor(method, sigma, threshold);
    if (sigma > threshold) {
      out.rank = i + 1;
      out.condition = singularValues_(0, 0) / sigma;
    }
    for (std::size_t k = 0; k < channels && f > 0; ++k)
      filtered(i, k) = f * rhs.modes(i, k) / sigma;
  }
  if (!heldOutValues.empty() && !heldOutModes_.empty()) {
    Matrix residual = heldOutResidual(rhs, heldOutValues);
    multiply(false, -1, heldOutModes_, filtered, 1, residual);
    double sum = 0;
    for (std::size_t i = 0; i < residual.rows() * channels; ++i)
      sum += residual.data()[i] * residual.data()[i];
    out.heldOutRms = std::sqrt(sum / static_cast<double>(residual.rows()));
  }
  Matrix weights(sources_, channels);
  multiply(true, 1, rightTransposed_, filtered, 0, weights);
  Matrix affine = rhs.affine;
  multiply(false, -1, coupling_, weights, 1, affine);

  out.affine.center = center_;
  out.affine.coefficients = Matrix(kAffineUnknowns, channels);
  for (std::size_t k = 0; k < channels; ++k) {
    out.affine.coefficients(0, k) = affine(0, k);
    for (std::size_t a = 1; a < kAffineUnknowns; ++a)
      out.affine.coefficients(a, k) = affine(a, k) / scale_;
  }
  const double valueSpan = span(values);
  if (valueSpan > 0) out.weightNorm = largestMagnitude(weights) / valueSpan;
  // 1 / |x - q| in world units is 1 / scale times the normalised kernel.
  for (std::size_t i = 0; i < sources_ * channels; ++i) weights.data()[i] *= scale_;
  out.weights = std::move(weights);
  return out;
}

DenseSolver::DenseSolver(const Collocation& collocation, const Points& sources,
                         const Collocation& heldOut)
    : factors_(std::make_shared<const Factors>(collocation, sources, heldOut)) {}

DenseSolution DenseSolver::solve(const Matrix& values, Regularization method,
                                 const Matrix& heldOutValues,
                                 std::optional<double> regularization) const {
  return factors_->solve(values, method, heldOutValues, regularization);
}

}  // namespace innermap
