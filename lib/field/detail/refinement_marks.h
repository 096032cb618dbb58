// Where an adaptive fit needs finer charges, by what it has tried there already.
#pragma once

#include <cstddef>
#include <vector>

#include "core/point_grid.h"
#include "innermap/core/vec3.h"
#include "innermap/field/fit.h"

namespace innermap {

// Levels are counted from 0, the first one, which covers all of the boundary; each is half as wide
// as the one before. Lengths are world units, errors and the tolerance fractions of the same unit.
class RefinementMarks {
 public:
  // jumps: AdaptiveProblem::jumps. spacing: of the first level's charges.
  RefinementMarks(const Points& jumps, double spacing, double tolerance);

  // How far about a mark charges of the level, from 1, are placed.
  double reach(std::size_t level) const;

  // The marks have been refined to the level, from 1, or there was no room for it.
  void tried(std::size_t level, const Points& marks);

  // The error of the points but those beside jumps that are left as they are: their errors are set
  // to 0.
  BoundaryError awayFromJumps(const Points& points, std::vector<double>& errors) const;

  // The points that ask for charges, by the level that these should be on. `error`: of all errors.
  std::vector<Points> byLevel(const Points& points, const std::vector<double>& errors,
                              const BoundaryError& error) const;

  // No error stands out.
  static bool isTame(const BoundaryError& error);

 private:
  double spacing(std::size_t level) const;
  std::size_t levelOf(const Vec3& p) const;
  std::vector<std::size_t> atJumps(const Points& points, const std::vector<double>& errors,
                                   std::size_t leastLevel) const;

  const double spacing_, tolerance_;
  const PointGrid jumps_;
  std::vector<PointGrid> tried_;  // of level 1 and on
};

}  // namespace innermap
