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
  // out (rounding and little else). The same for any number of threads.
  void add(Matrix directions, Matrix images);

  // Removes from `residual` (#images x #K) its part along each direction from number `first` on,
  // and adds the same multiple of the direction to `x` (#unknowns x #K). Skips a direction that
  // gains next to nothing for a large change of x: such ones are almost in the operator's null
  // space.
  void project(std::size_t first, Matrix& residual, Matrix& x) const;

  std::size_t count() const { return column_.size(); }

 private:
  struct Block {
    Matrix directions, images;
  };
  struct Column {
    std::size_t block, index;
    double step;  // length of the direction
  };

  void removeParts(const Block& old, Block& fresh) const;
  bool normalise(Block& block, std::size_t column) const;

  std::size_t images_, unknowns_;
  std::vector<Block> blocks_;
  std::vector<Column> column_;
};

}  // namespace innermap
