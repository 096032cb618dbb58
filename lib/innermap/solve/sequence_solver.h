// Right-hand sides one after the other that resemble each other: the frames of an animation.
//
// A new right-hand side is first projected onto what the solution before gives at the collocation
// points, which is known without a product (Fischer, "Projection Techniques for Iterative Solution
// of Ax = b with Successive Right-Hand Sides", 1998). What is left takes
// about two iterations, and none of the set-up.
#pragma once

#include <memory>

#include "innermap/solve/iterative_solver.h"

namespace innermap {

// Holds kept work: one thread at a time. The same solutions for any number of threads and the same
// order of right-hand sides; another order gives slightly different ones, equally good.
class SequenceSolver {
 public:
  explicit SequenceSolver(IterativeSolver solver);
  SequenceSolver(SequenceSolver&&) noexcept;
  SequenceSolver& operator=(SequenceSolver&&) noexcept;
  ~SequenceSolver();

  // values: #collocation x #K, as in IterativeSolver::solve. `residuals` starts behind the
  // projection. Throws as IterativeSolver::solve does; what was kept then stays.
  IterativeSolution solve(const Matrix& values);

  const IterativeSolver& solver() const { return solver_; }

 private:
  void keep(Matrix values, const Matrix& residual, Matrix x);

  IterativeSolver solver_;
  std::unique_ptr<OrthogonalDirections> solutions_;  // the last
};

}  // namespace innermap
