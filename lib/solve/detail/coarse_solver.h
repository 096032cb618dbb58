// Dense regularised least squares for a few charges and the affine part: the
// coarse level of IterativeSolver. By the normal equations, as their solution only
// preconditions, and regularisation bounds what they lose.
#pragma once

#include <cstdint>

#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"
#include "innermap/solve/solver.h"

namespace innermap {

class CoarseSolver {
 public:
  static constexpr std::size_t kAffine = 4;           // 1, x, y, z
  static constexpr std::size_t kPointsPerSource = 4;  // rows that it takes at most

  CoarseSolver() = default;

  // Over at most kPointsPerSource collocation points a charge, drawn at random by `seed`.
  CoarseSolver(const Collocation& collocation, const Points& sources, std::uint64_t seed);

  // (4 + #sources) x #K: the affine part, then the weights, for residual (#collocation x #K, or
  // more rows, which play no part).
  Matrix correction(const Matrix& residual) const;

 private:
  std::vector<std::size_t> rows_;
  Matrix matrix_;  // at these rows
  Matrix factor_;  // of its normal matrix: lower triangle
};

std::uint64_t coarseSolverMemory(std::size_t sources);

}  // namespace innermap
