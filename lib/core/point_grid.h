// Points in a hashed grid of cubic cells, for searches among points that are still being added.
#pragma once

#include <cstdint>
#include <vector>

#include "innermap/core/vec3.h"

namespace innermap {

// Searches are exact whatever the cells; they are fast when a search covers a few cells and a cell
// holds a few points. Safe from any number of threads while nothing is added.
class PointGrid {
 public:
  // Edge of a cell, positive, in the points' units.
  explicit PointGrid(double cell);
  PointGrid(const Points& points, double cell);

  void add(const Vec3& p);  // gets the next index, from 0
  std::size_t size() const { return points_.size(); }

  // Indices, ascending, of the points in the box widened by `margin` on all sides, its faces
  // included.
  std::vector<std::size_t> within(const Box3& box, double margin = 0) const;

  // Whether some point is nearer to p than `radius`.
  bool anyNearer(const Vec3& p, double radius) const;

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::int64_t last = -1;  // the point added last to this cell; -1: the slot is free
  };
  struct Range {
    std::int64_t lower[3], upper[3];
    bool worthwhile;  // fewer cells than points
  };

  std::int64_t cellOf(double x, int axis) const;
  std::uint64_t slotOf(std::uint64_t key) const;
  Range rangeOf(const Vec3& lower, const Vec3& upper) const;
  void grow();
  // Calls visit(index) for the points of all cells of the range until it returns true.
  template <typename Visit>
  bool visitCells(const Range& range, const Visit& visit) const;

  double inverseCell_;
  int shift_ = 58;  // 64 less the binary logarithm of the number of slots
  Vec3 origin_;
  Points points_;
  std::vector<std::int64_t> previous_;  // in the same cell
  std::vector<Slot> slots_;
  std::size_t used_ = 0;
};

}  // namespace innermap
