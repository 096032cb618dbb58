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
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"
#include "innermap/solve/affine.h"
#include "innermap/solve/collocation.h"

namespace innermap {

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

  const Matrix& singularValues() const;  // #sources x 1, decreasing

 private:
  class Factors;
  std::shared_ptr<const Factors> factors_;
};

// Peak need of a DenseSolver in bytes.
std::uint64_t denseSolverMemory(std::size_t collocation, std::size_t sources, std::size_t heldOut);

}  // namespace innermap
