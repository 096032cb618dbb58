// Restricted additive Schwarz for the charges of one level (Cai and Sarkis, "A
// Restricted Additive Schwarz Preconditioner", 1999): a regularised least-squares problem for each
// cluster of charges with its surroundings, of whose solution the cluster's own weights are kept.
#pragma once

#include <cstdint>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"
#include "innermap/solve/solver.h"

namespace innermap {

class LocalSolver {
 public:
  // Of the level's charges, in the units of the points given later.
  LocalSolver(double spacing, double distance) : spacing_(spacing), distance_(distance) {}

  // Takes more charges and factors clusters of them, which see the charges of this level that are
  // there and all collocation points; the clusters that are there stay as they are. `collocation`
  // is that of earlier calls with points added at the end.
  void add(const Points& sources, const Collocation& collocation);

  // Weights that lower the residual (#collocation x #K), of the charges from number `first` on,
  // where an add() began ((#charges of the level - first) x #K); rows beyond what a cluster has
  // seen play no part in it.
  Matrix correction(const Matrix& residual, std::size_t first = 0) const;

  const Points& sources() const { return sources_; }
  double spacing() const { return spacing_; }

 private:
  struct Cluster {
    std::vector<std::size_t> sources, rows;
    std::vector<float> solve;  // #rows x #sources, column-major: own rows of G^-1 A^T, transposed
  };

  void factor(Cluster& cluster, const std::vector<std::size_t>& around,
              const Collocation& collocation) const;

  double spacing_, distance_;
  Points sources_;
  std::vector<Cluster> clusters_;
};

// Estimate of the peak need in bytes of the clusters for so many sources of one level.
// refined: finer levels stand in places only.
std::uint64_t localSolverMemory(std::size_t collocation, std::size_t sources, bool refined);

}  // namespace innermap
