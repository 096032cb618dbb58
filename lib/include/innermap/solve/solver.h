// Affine functions of position: the harmonic part that a sum of charges is bad at.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"

namespace innermap {

// value_k(p) = c(0, k) + c(1, k) (p - center).x + c(2, k) (p - center).y + c(3, k) (p - center).z
struct Affine {
  Vec3 center;
  Matrix coefficients;  // 4 x #K

  double value(const Vec3& p, std::size_t channel) const {
    const Vec3 d = p - center;
    return coefficients(0, channel) + coefficients(1, channel) * d.x +
           coefficients(2, channel) * d.y + coefficients(3, channel) * d.z;
  }
};

// Where a field is fitted and what it is asked for there: one row of the least squares a point.

struct Collocation {
  Points points;
  // Empty: the field's value everywhere. Else one a point: zero asks for the value, any other one
  // for its scalar product with the gradient, which is the derivative along it times its length.
  // The length weights the row: a derivative counts as the change of value over it.
  Points directions;

  Collocation() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): points alone ask for values
  Collocation(Points at, Points along = {}) : points(std::move(at)), directions(std::move(along)) {}

  std::size_t size() const { return points.size(); }
  bool derivative(std::size_t i) const {
    return !directions.empty() &&
           (directions[i].x != 0 || directions[i].y != 0 || directions[i].z != 0);
  }
  // What the row of point i makes of the affine functions 1, x, y, z.
  std::array<double, 4> affine(std::size_t i) const {
    const Vec3& v = derivative(i) ? directions[i] : points[i];
    return {derivative(i) ? 0.0 : 1.0, v.x, v.y, v.z};
  }
  // In units of `scale` about `center`: the same rows for fields in these units.
  Collocation normalised(const Vec3& center, double scale) const;
  Collocation subset(const std::vector<std::size_t>& indices) const;
  void append(const Collocation& other);
};

// Rows where derivatives are asked for: those indices, in order.
std::vector<std::size_t> derivativeRows(const Collocation& at);

// Fills #points x 4 by the affine functions' rows, column-major with the given stride.
void fillAffineRows(const Collocation& at, double* out, std::size_t rowStride);

// Overwrites these rows of #points x #sources, `column`-major with the given stride, by
//   -direction . (point - source) / |point - source|^3.
void fillDerivativeRows(const Collocation& at, const Points& sources, double* out,
                        std::size_t rowStride);

// The rows' values of a field: #points x #K. values: #points x #K; gradients: of derivativeRows(at)
// alone, #rows x 3 #K, columns 3 k + axis.
Matrix rowValues(const Collocation& at, Matrix values, const Matrix& gradients);

// Regularised least squares for the weights of point charges, by one dense factorization that
// serves any number of right-hand sides.
//
// The unknown function is an affine function plus a sum of charges. With P (collocation points x 4)
// for the affine part and A (collocation points x sources, entries 1/r) for the charges,
//   [P A] = Q R,  R = [R11 R12; 0 R22],  R22 = U S V^T,
// the affine part is never regularised, and the weights follow from the SVD of R22 by filter
// factors: truncation (Li et al., "Meshless Harmonic Volumetric Mapping Using Fundamental Solution
// Methods", 2009; Hansen, "Rank-Deficient and Discrete Ill-Posed Problems", 1998) or Tikhonov's
// s^2 / (s^2 + lambda^2). QR first keeps the SVD small (Chan, "An Improved Algorithm for Computing
// the Singular Value Decomposition", 1982).

enum class Regularization { truncatedSvd, tikhonov };

struct DenseSolution {
  Matrix weights;             // #sources x #K, for kernel 1/r in world units
  Affine affine;              // world units
  double regularization = 0;  // threshold or lambda, relative to the largest singular value
  std::size_t rank = 0;       // singular values above it
  double condition = 0;       // largest over smallest singular value above it; 0 for rank 0
  double weightNorm = 0;      // largest absolute weight over the span of the values times the
                              // span of the points: about 1 for harmless fits, dimensionless
  double heldOutRms = 0;      // in the values' units; 0 when there were no held-out points
};

// Immutable; copies share their data; safe from any number of threads.
class DenseSolver {
 public:
  // collocation: at least #sources + 4 points; heldOut: points that choose the regularisation, may
  // be empty. Throws SettingError, MemoryError (before allocating), Cancelled (within one panel;
  // but the SVD itself is one LAPACK call and finishes first).
  DenseSolver(const Collocation& collocation, const Points& sources, const Collocation& heldOut);

  // values: #collocation x #K, the rows' (see Collocation). Without `regularization` it is chosen
  // by the rms error at the held-out points (heldOutValues: #heldOut x #K, required then): of all
  // candidates, a quarter decade apart, the strongest within 2% of the best. Given: relative to the
  // largest singular value, in [0, 1].
  DenseSolution solve(const Matrix& values, Regularization method, const Matrix& heldOutValues,
                      std::optional<double> regularization = {}) const;

 private:
  class Factors;
  std::shared_ptr<const Factors> factors_;
};

// Peak need of a DenseSolver in bytes.
std::uint64_t denseSolverMemory(std::size_t collocation, std::size_t sources, std::size_t heldOut);

// Least squares for the weights of tens of thousands of point charges, without their dense matrix.
//
// The charges stand on levels of falling distance and spacing. Block GCR (Eisenstat, Elman,
// Schultz, "Variational Iterative Methods for Nonsymmetric Systems of Linear Equations", 1983) on
// the true residual ||b - A x||: each iteration goes through the levels, coarse to fine, and each
// gives one direction a channel, which all channels share, orthogonal to all others in the image of
// A:
//   the first level dense least squares for its charges and the affine part,
//   every other one restricted additive Schwarz, a regularised least-squares problem a cluster of
//   charges with its surroundings.
// Rows may ask for derivatives instead of values (Collocation). The residual falls monotonically;
// stopping early regularises. Memory is linear in the number of charges beyond the first level; the
// number of iterations does not grow with it.

// Charges at one distance from the boundary, about 0.8 to 1.3 of their spacing. World units,
// both positive.
struct SourceLevel {
  Points sources;
  double spacing = 0, distance = 0;
};

struct IterativeSettings {
  int maxIterations = 8;   // in [1, 100]
  double accuracy = 1e-7;  // of products, fraction of the values' span; in [1e-12, 1e-3]
  std::uint64_t seed = 1;  // of the rows that the first level sees
};

struct IterativeSolution {
  Matrix weights;  // #sources x #K in the order of IterativeSolver::sources(), for kernel 1/r
  Affine affine;   // world units, as the weights
  int iterations = 0;
  std::vector<double> residuals;  // rms at the collocation points before and after each iteration
  double weightNorm = 0;          // as in DenseSolution
  // The largest error of a product that was less exact than asked for, fraction of the values'
  // span: where weights nearly cancel and their number leaves no plain sums; see FastSum::at. 0:
  // none.
  double productError = 0;
  Matrix residual;  // values less field at the collocation points, #collocation x #K
};

// What is built serves any number of right-hand sides; const functions may be called from several
// threads.
class IterativeSolver {
 public:
  // collocation: 2 to 4 points a source, some of them with values. levels: at least one, of falling
  // spacing. The first, solved densely, best has 500 to 3000 charges. One level alone is a dense
  // solver. Throws SettingError, MemoryError (before allocating), Cancelled.
  IterativeSolver(const Collocation& collocation, const std::vector<SourceLevel>& levels,
                  const IterativeSettings& settings = {});
  IterativeSolver(IterativeSolver&&) noexcept;
  IterativeSolver& operator=(IterativeSolver&&) noexcept;
  ~IterativeSolver();

  // More points, and more charges beyond the first level: a level of the same spacing as one that
  // is there (to 1e-6 of it) joins it. Only the new charges' clusters are factored. Points and
  // charges are numbered on from those that are there. Throws as above; what was there then stays
  // as it was only before a MemoryError or SettingError.
  void add(const Collocation& collocation, const std::vector<SourceLevel>& levels);

  // values: #collocation x #K, the rows' (see Collocation). start: an earlier solution of this
  // solver, for the same values at the points that there were then. Same result for any number of
  // threads. Throws DataError when the sizes do not fit.
  IterativeSolution solve(const Matrix& values, const IterativeSolution* start = nullptr) const;

  const Points& sources() const;  // all levels', world units
  std::size_t collocation() const;

 private:
  class Levels;
  std::unique_ptr<Levels> levels_;
};

// Estimate of the peak need in bytes; coarse: sources of the first level, sources: of the others.
// refined: finer levels stand in places only, as add() puts them.
std::uint64_t iterativeSolverMemory(std::size_t collocation, std::size_t sources,
                                    std::size_t coarse, bool refined = false);

}  // namespace innermap
