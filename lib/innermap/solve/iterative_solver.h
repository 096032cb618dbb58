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
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"
#include "innermap/solve/affine.h"
#include "innermap/solve/collocation.h"

namespace innermap {

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
