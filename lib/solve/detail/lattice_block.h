// A harmonic polynomial and its gradient at the 8^3 points of a lattice block.
//
// The block is its own mirror image along each axis and so is every harmonic, up to its sign: the
// polynomial is summed at the 4^3 points of one octant for each of the eight parities, and put
// together by sums and differences. An eighth of the work of the plain product.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "solve/detail/row.h"
#include "solve/detail/solid_harmonics.h"

namespace innermap {

class LatticeBlock {
 public:
  static constexpr std::size_t kPoints = 512;
  // Of the ball about the block, in spacings.
  static double radius();

  explicit LatticeBlock(const SolidHarmonics& harmonics);

  // coefficients: `stride` x 3, in units of the ball. Point (x, y, z) of the block is at 64 x + 8 y
  // + z. values: 512 x 3; gradients (may be null): 512 x 9, columns 3 k + axis, times `slope`.
  // Overwrites.
  void evaluate(const double* coefficients, std::size_t stride, double slope, double* values,
                double* gradients) const;

 private:
  void evaluateThree(const double* coefficients, double* out, std::size_t outStride) const;

  const SolidHarmonics& harmonics_;
  std::vector<std::size_t> order_;  // functions by parity
  std::array<std::size_t, 9> begin_{};
  simd::Row octant_;                                      // 64 x functions, in that order
  std::array<std::array<std::uint16_t, 64>, 8> place_{};  // of the octant's points for each sign
};

}  // namespace innermap
