// Internal to sample/. Points in a hashed grid of cubic cells, for searches within one fixed
// radius.
#pragma once

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

  // Calls visit(j, squared distance) for each point j != i within the radius of point i (positions
  // in the order of cells), always in the same order.
  template <typename Visit>
  void forNeighbours(std::size_t i, const Visit& visit) const {
    const Vec3& p = points_[i];
    const std::uint64_t base = keyOf(p);
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        // The three cells along z have consecutive keys.
        const std::uint64_t row =
            base + static_cast<std::uint64_t>(x) * kStepX + static_cast<std::uint64_t>(y) * kStepY;
        for (int z = -1; z <= 1; ++z) {
          const std::uint32_t cell = find(row + static_cast<std::uint64_t>(z));
          if (cell == kNone) continue;
          for (std::uint32_t j = starts_[cell]; j < starts_[cell + 1]; ++j) {
            const double squared = squaredNorm(points_[j] - p);
            if (squared < squaredRadius_ && j != i) visit(j, squared);
          }
        }
      }
    }
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  static constexpr std::uint64_t kStepY = std::uint64_t(1) << 21, kStepX = std::uint64_t(1) << 42;

  std::uint64_t keyOf(const Vec3& p) const;
  std::uint32_t find(std::uint64_t key) const {
    for (std::uint64_t slot = (key * 0x9e3779b97f4a7c15u) >> shift_;; slot = (slot + 1) & mask_) {
      if (table_[slot].cell == kNone || table_[slot].key == key) return table_[slot].cell;
    }
  }

  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t cell = kNone;
  };

  Vec3 lower_;
  double inverseCell_ = 1, squaredRadius_ = 0;
  Points points_;
  std::vector<std::uint32_t> index_, starts_;
  std::vector<Slot> table_;
  std::uint64_t mask_ = 0;
  int shift_ = 63;
};

}  // namespace innermap
