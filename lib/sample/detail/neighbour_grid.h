// Points in a sparse grid of cubic cells, for searches within one fixed
// radius.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "innermap/core/vec3.h"

namespace innermap {

class NeighbourGrid {
 public:
  // Finds points within `radius` (> 0). Cells are that large, or larger where the points spread
  // over more than 2^20 radii.
  NeighbourGrid(const Points& points, double radius);

  // Points in the order of cells, with the indices they had.
  std::size_t size() const { return points_.size(); }
  const Vec3& point(std::size_t i) const { return points_[i]; }
  std::size_t index(std::size_t i) const { return index_[i]; }

  // The consecutive ranges of points that make up the cells.
  const std::vector<std::uint32_t>& cellStarts() const { return starts_; }

  // The cells in groups by cubes of 2^log2Width cells a side: indices into cellStarts().
  std::vector<std::vector<std::uint32_t>> cubes(int log2Width) const;

  // Calls visit(j, squared distance) for each point j != i within the radius of point i (positions
  // in the order of cells), always in the same order.
  template <typename Visit>
  void forNeighbours(std::size_t i, const Visit& visit) const {
    const Vec3 p = points_[i];
    for (const Range& row : rows_[cellOf_[i]]) {
      for (std::uint32_t j = row.begin; j < row.end; ++j) {
        const double squared = squaredNorm(points_[j] - p);
        if (squared < squaredRadius_ && j != i) visit(j, squared);
      }
    }
  }

 private:
  static constexpr int kBits = 21;  // of the key for each axis
  static constexpr std::uint64_t kStepY = std::uint64_t(1) << kBits, kStepX = kStepY << kBits;

  struct Range {
    std::uint32_t begin = 0, end = 0;
  };
  // The cells about a cell, three at a time: those along z have consecutive keys, so their points
  // are consecutive too.
  using Rows = std::array<Range, 9>;

  std::uint64_t keyOf(const Vec3& p) const;
  void findRows();

  Vec3 lower_;
  double inverseCell_ = 1, squaredRadius_ = 0;
  Points points_;
  std::vector<std::uint32_t> index_, cellOf_, starts_;
  std::vector<std::uint64_t> keys_;  // of the cells, ascending
  std::vector<Rows> rows_;
};

}  // namespace innermap
