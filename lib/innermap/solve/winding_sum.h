// Generalized winding numbers of a triangle soup at many points, by the same hierarchy as sums of
// charges: a triangle is a layer of dipoles, whose far field is harmonic (Jacobson, Kavan,
// Sorkine-Hornung, "Robust Inside-Outside Segmentation using Generalized Winding Numbers", SIGGRAPH
// 2013). For any accuracy; a single point at a time is faster by mesh/winding_number.h.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "innermap/core/progress.h"
#include "innermap/core/vec3.h"
#include "innermap/solve/fast_sum.h"

namespace innermap {

// Immutable, thread-safe; copies share their data.
class WindingSum {
 public:
  // triangles: corners as indices of vertices, counter-clockwise seen from outside. Throws
  // DataError for an index out of range or a vertex that is not finite.
  WindingSum(const Points& vertices, const std::vector<std::array<int, 3>>& triangles);

  // About 1 inside a closed outward mesh, 0 outside. accuracy: root mean square error, in [1e-12,
  // 0.1]; on the surface itself the number is undefined. Same result for any number of threads.
  // Throws SettingError, DataError (a point is not finite), Cancelled.
  std::vector<double> at(const Points& points, double accuracy = 1e-3, Progress* progress = nullptr,
                         SumMethod method = SumMethod::cheapest) const;

  // The plain sum of solid angles, O(#triangles).
  double exactAt(const Vec3& point) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace innermap
