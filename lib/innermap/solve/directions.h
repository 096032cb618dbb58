// Search directions of a block GCR method, orthonormal in the image of the operator.
#pragma once

#include <vector>

#include "innermap/core/matrix.h"

namespace innermap {

class OrthogonalDirections {
 public:
  OrthogonalDirections(std::size_t images, std::size_t unknowns)
      : images_(images), unknowns_(unknowns) {}

  // Adds the columns of `directions` (#unknowns x n) and of their `images` (#images x n), made
  // orthonormal to all that are there (Gram-Schmidt, twice); columns that depend on those are left
  // out.
  void add(const Matrix& directions, const Matrix& images);

  // Removes from `residual` (#images x #K) its part along each direction added since the last
  // call, and adds the same multiple of the direction to `x` (#unknowns x #K). Skips a direction
  // that gains next to nothing for a large change of x: such ones are almost in the operator's null
  // space.
  void project(Matrix& residual, Matrix& x);

 private:
  using Column = std::vector<double>;
  std::size_t images_, unknowns_, projected_ = 0;
  std::vector<Column> direction_, image_;
};

}  // namespace innermap
