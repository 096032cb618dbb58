#include "core/point_grid.h"

#include <algorithm>
#include <cmath>

#include "innermap/core/error.h"

namespace innermap {
namespace {

constexpr double kFarthestCell = 1e15;
constexpr std::int64_t kWidest = std::int64_t(1) << 20;  // cells; keys repeat after twice as many

std::uint64_t keyOf(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::uint64_t kMask = (std::uint64_t(1) << 21) - 1;
  return (static_cast<std::uint64_t>(x) & kMask) << 42 |
         (static_cast<std::uint64_t>(y) & kMask) << 21 | (static_cast<std::uint64_t>(z) & kMask);
}

}  // namespace

PointGrid::PointGrid(double cell)
    : inverseCell_(1 / cell), slots_(std::size_t(1) << (64 - shift_)) {
  if (!(cell > 0) || !std::isfinite(inverseCell_))
    throw SettingError("cell", "must be positive and finite");
}

PointGrid::PointGrid(const Points& points, double cell) : PointGrid(cell) {
  points_.reserve(points.size());
  for (const Vec3& p : points) add(p);
}

std::int64_t PointGrid::cellOf(double x, int axis) const {
  const double cell = std::floor((x - origin_[axis]) * inverseCell_);
  return static_cast<std::int64_t>(std::clamp(cell, -kFarthestCell, kFarthestCell));
}

// The slot that holds the key, or the free one where it belongs. By the highest bits of a product
// (Knuth, The Art of Computer Programming 3, 6.4): those below bit 42 do not depend on x.
std::uint64_t PointGrid::slotOf(std::uint64_t key) const {
  const std::uint64_t mask = slots_.size() - 1;
  std::uint64_t slot = (key * 0x9e3779b97f4a7c15u) >> shift_;
  while (slots_[slot].last >= 0 && slots_[slot].key != key) slot = (slot + 1) & mask;
  return slot;
}

void PointGrid::grow() {
  std::vector<Slot> old(2 * slots_.size());
  old.swap(slots_);
  --shift_;
  for (const Slot& s : old)
    if (s.last >= 0) slots_[slotOf(s.key)] = s;
}

void PointGrid::add(const Vec3& p) {
  if (points_.empty()) origin_ = p;
  if (2 * (used_ + 1) > slots_.size()) grow();
  const std::uint64_t key = keyOf(cellOf(p.x, 0), cellOf(p.y, 1), cellOf(p.z, 2));
  Slot& slot = slots_[slotOf(key)];
  if (slot.last < 0) {
    slot.key = key;
    ++used_;
  }
  previous_.push_back(slot.last);
  slot.last = static_cast<std::int64_t>(points_.size());
  points_.push_back(p);
}

PointGrid::Range PointGrid::rangeOf(const Vec3& lower, const Vec3& upper) const {
  Range range{{}, {}, true};
  double cells = 1;
  for (int a = 0; a < 3; ++a) {
    range.lower[a] = cellOf(lower[a], a);
    range.upper[a] = cellOf(upper[a], a);
    const std::int64_t width = range.upper[a] - range.lower[a] + 1;
    cells *= static_cast<double>(width);
    range.worthwhile = range.worthwhile && width < kWidest;
  }
  range.worthwhile = range.worthwhile && cells < static_cast<double>(points_.size()) + 8;
  return range;
}

template <typename Visit>
bool PointGrid::visitCells(const Range& range, const Visit& visit) const {
  for (std::int64_t x = range.lower[0]; x <= range.upper[0]; ++x)
    for (std::int64_t y = range.lower[1]; y <= range.upper[1]; ++y)
      for (std::int64_t z = range.lower[2]; z <= range.upper[2]; ++z)
        for (std::int64_t i = slots_[slotOf(keyOf(x, y, z))].last; i >= 0;
             i = previous_[static_cast<std::size_t>(i)])
          if (visit(static_cast<std::size_t>(i))) return true;
  return false;
}

std::vector<std::size_t> PointGrid::within(const Box3& box, double margin) const {
  const Vec3 wide{margin, margin, margin}, lower = box.lower - wide, upper = box.upper + wide;
  std::vector<std::size_t> out;
  const auto take = [&](std::size_t i) {
    const Vec3& p = points_[i];
    if (p.x >= lower.x && p.x <= upper.x && p.y >= lower.y && p.y <= upper.y && p.z >= lower.z &&
        p.z <= upper.z)
      out.push_back(i);
    return false;
  };
  const Range range = rangeOf(lower, upper);
  if (!range.worthwhile) {
    for (std::size_t i = 0; i < points_.size(); ++i) take(i);
    return out;
  }
  visitCells(range, take);
  std::sort(out.begin(), out.end());
  return out;
}

bool PointGrid::anyNearer(const Vec3& p, double radius) const {
  const Vec3 reach{radius, radius, radius};
  const double squared = radius * radius;
  const auto near = [&](std::size_t i) { return squaredNorm(points_[i] - p) < squared; };
  const Range range = rangeOf(p - reach, p + reach);
  if (range.worthwhile) return visitCells(range, near);
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (near(i)) return true;
  return false;
}

}  // namespace innermap
