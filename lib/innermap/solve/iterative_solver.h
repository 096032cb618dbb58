// Least squares for the weights of tens of thousands of point charges, without their dense matrix.
//
// Block GCR (Eisenstat, Elman, Schultz, "Variational Iterative Methods for Nonsymmetric Systems of
// Linear Equations", 1983) on the true residual ||b - A x||: each iteration gives two directions a
// channel, which all channels share,
//   a coarse one: dense least squares for charges on a farther shell and the affine part, and
//   a local one: restricted additive Schwarz, a regularised least-squares problem a cluster of
//   charges with its surroundings (Cai and Sarkis, "A Restricted Additive Schwarz Preconditioner",
//   1999),
// made orthogonal in the image of A. The residual falls monotonically; stopping early regularises.
// Memory is linear in the number of charges; the number of iterations does not grow with it.
#pragma once

#include <cstdint>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/progress.h"
#include "innermap/core/vec3.h"
#include "innermap/solve/affine.h"
#include "innermap/solve/blocked_qr.h"

namespace innermap {

struct IterativeSettings {
  double spacing = 0;           // of the sources, world units: sqrt(area / number); positive
  double distance = 0;          // of the sources from the boundary, world units; positive
  int maxIterations = 8;        // in [1, 100]
  std::uint64_t seed = 1;       // of the rows that the coarse problem sees
  std::uint64_t maxMemory = 0;  // bytes; 0 means no limit
  Progress* progress = nullptr;
};

struct IterativeSolution {
  Matrix weights;  // #sources (then #coarse) x #K, for kernel 1/r in world units
  Affine affine;   // world units
  int iterations = 0;
  std::vector<double> residuals;  // rms at the collocation points before and after each iteration
  double weightNorm = 0;          // as in DenseSolution
};

// Immutable after construction: what is built serves any number of right-hand sides.
class IterativeSolver {
 public:
  // collocation: 2 to 4 points a source; coarse: 500 to 3000 more sources on a shell at about 1.25
  // of their own, wider spacing. Throws SettingError, MemoryError (before allocating), Cancelled.
  IterativeSolver(const Points& collocation, const Points& sources, const Points& coarse,
                  const IterativeSettings& settings);

  // values: #collocation x #K. Same result for any number of threads.
  IterativeSolution solve(const Matrix& values) const;

 private:
  struct Cluster {
    std::vector<std::size_t> sources, rows;
    std::vector<float> solve;  // #sources x #rows, row-major: own rows of G^-1 A^T
  };
  struct Unknowns {
    Matrix affine, weights;  // 4 x #K, (#sources + #coarse) x #K
  };

  struct Scaled {
    Matrix values;
    std::vector<double> middle;  // of each channel
    double size = 0;             // of the widest channel
  };

  void buildCluster(Cluster& cluster) const;
  void buildCoarse(const Points& far);
  Scaled scaled(const Matrix& values) const;
  void unscale(const Scaled& scaled, const Matrix& x, IterativeSolution& out) const;
  Unknowns coarseCorrection(const Matrix& residual) const;
  Unknowns localCorrection(const Matrix& residual) const;
  Matrix apply(const Unknowns& x, std::size_t first, std::size_t last) const;

  IterativeSettings settings_;
  Vec3 center_;
  double scale_ = 1;
  Points collocation_, sources_;  // normalised; sources_: fine ones, then coarse ones
  std::size_t fine_ = 0;
  std::vector<Cluster> clusters_;
  std::vector<std::size_t> coarseRows_;
  BlockedQr coarseQr_;
  Matrix coarseTriangle_;
};

// Estimate of the peak need in bytes.
std::uint64_t iterativeSolverMemory(std::size_t collocation, std::size_t sources,
                                    std::size_t coarse);

}  // namespace innermap
