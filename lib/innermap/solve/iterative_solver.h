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
// The residual falls monotonically; stopping early regularises. Memory is linear in the number of
// charges beyond the first level; the number of iterations does not grow with it.
#pragma once

#include <cstdint>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/progress.h"
#include "innermap/core/vec3.h"
#include "innermap/solve/affine.h"
#include "innermap/solve/detail/coarse_solver.h"
#include "innermap/solve/detail/local_solver.h"

namespace innermap {

// Charges at one distance from the boundary, about 0.8 to 1.3 of their spacing. World units,
// both positive.
struct SourceLevel {
  Points sources;
  double spacing = 0, distance = 0;
};

struct IterativeSettings {
  int maxIterations = 8;        // in [1, 100]
  double accuracy = 1e-7;       // of products, fraction of the values' span; in [1e-12, 1e-3]
  std::uint64_t seed = 1;       // of the rows that the first level sees
  std::uint64_t maxMemory = 0;  // bytes; 0 means no limit
  Progress* progress = nullptr;
};

struct IterativeSolution {
  Matrix weights;  // #sources x #K in the order of IterativeSolver::sources(), for kernel 1/r
  Affine affine;   // world units, as the weights
  int iterations = 0;
  std::vector<double> residuals;  // rms at the collocation points before and after each iteration
  double weightNorm = 0;          // as in DenseSolution
  Matrix residual;                // values less field at the collocation points, #collocation x #K
};

class OrthogonalDirections;

// What is built serves any number of right-hand sides; const functions may be called from several
// threads.
class IterativeSolver {
 public:
  // collocation: 2 to 4 points a source. levels: at least one, of falling spacing. The first,
  // solved densely, best has 500 to 3000 charges. One level alone is a dense solver. Throws
  // SettingError, MemoryError (before allocating), Cancelled.
  IterativeSolver(const Points& collocation, const std::vector<SourceLevel>& levels,
                  const IterativeSettings& settings = {});

  // More points, and more charges beyond the first level: a level of the same spacing as one that
  // is there (to 1e-6 of it) joins it. Only the new charges' clusters are factored. Points and
  // charges are numbered on from those that are there. Throws as above; what was there then stays
  // as it was only before a MemoryError or SettingError.
  void add(const Points& collocation, const std::vector<SourceLevel>& levels);

  // values: #collocation x #K. start: an earlier solution of this solver, for the same values at
  // the points that there were then. Same result for any number of threads. Throws DataError when
  // the sizes do not fit.
  IterativeSolution solve(const Matrix& values, const IterativeSolution* start = nullptr) const;

  const Points& sources() const { return sources_; }  // all levels', world units
  std::size_t collocation() const { return collocation_.size(); }

 private:
  struct Level {
    LocalSolver solver;
    std::vector<std::size_t> sources;  // indices into sources_
  };
  struct Scaled;

  void check(const Points& collocation, const std::vector<SourceLevel>& levels, bool first) const;
  void addPoints(const Points& collocation);
  std::vector<std::size_t> addSources(const Points& sources);
  void addLevel(const SourceLevel& level);
  Scaled scaled(const Matrix& values) const;
  void startFrom(const IterativeSolution& start, const Scaled& values, Matrix& residual,
                 Matrix& x) const;
  Matrix scaledStart(const IterativeSolution& start, const Scaled& values) const;
  IterativeSolution iterate(const Scaled& values, Matrix& residual, Matrix& x) const;
  void runLevels(OrthogonalDirections& directions, Matrix& residual, Matrix& x) const;
  void takeDirections(const Matrix& weights, const std::vector<std::size_t>& rows,
                      const Points& sources, OrthogonalDirections& directions, Matrix& residual,
                      Matrix& x) const;
  void unscale(const Scaled& values, const Matrix& residual, const Matrix& x,
               IterativeSolution& out) const;
  Matrix image(const Matrix& weights, const Points& sources, const Points& points,
               double accuracy) const;
  Points normalised(const Points& points) const;
  std::size_t unknowns() const { return CoarseSolver::kAffine + sources_.size(); }

  IterativeSettings settings_;
  Vec3 center_;
  double scale_ = 1;
  Points collocation_;    // normalised
  Points sources_;        // world units
  Points coarseSources_;  // normalised
  std::vector<std::size_t>
      coarseRows_;  // of the affine part and the first level among the unknowns
  CoarseSolver coarse_;
  std::vector<Level> levels_;  // beyond the first, of falling spacing
};

// Estimate of the peak need in bytes; coarse: sources of the first level, sources: of the others.
std::uint64_t iterativeSolverMemory(std::size_t collocation, std::size_t sources,
                                    std::size_t coarse);

}  // namespace innermap
