#include "innermap/sample/neighbour_grid.h"

#include <tbb/parallel_sort.h>

#include <algorithm>

#include "innermap/core/parallel.h"

namespace innermap {

NeighbourGrid::NeighbourGrid(const Points& points, double radius)
    : squaredRadius_(radius * radius) {
  const Box3 box = boundingBox(points);
  lower_ = points.empty() ? Vec3{} : box.lower;
  const Vec3 e = points.empty() ? Vec3{} : box.extent();
  const double longest = std::max({e.x, e.y, e.z});
  inverseCell_ = 1 / std::max(radius, longest / (1 << 20));

  struct Entry {
    std::uint64_t key;
    std::uint32_t index;
  };
  std::vector<Entry> entries(points.size());
  parallelBlocks(points.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      entries[i] = {keyOf(points[i]), static_cast<std::uint32_t>(i)};
    }
  });
  tbb::parallel_sort(entries.begin(), entries.end(), [](const Entry& x, const Entry& y) {
    return x.key < y.key || (x.key == y.key && x.index < y.index);
  });
  points_.reserve(points.size());
  index_.reserve(points.size());
  std::vector<std::uint64_t> keys;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (i == 0 || entries[i].key != entries[i - 1].key) {
      starts_.push_back(static_cast<std::uint32_t>(i));
      keys.push_back(entries[i].key);
    }
    points_.push_back(points[entries[i].index]);
    index_.push_back(entries[i].index);
  }
  starts_.push_back(static_cast<std::uint32_t>(points.size()));

  int bits = 4;
  while ((std::size_t(1) << bits) < 2 * keys.size()) ++bits;
  table_.resize(std::size_t(1) << bits);
  mask_ = table_.size() - 1;
  shift_ = 64 - bits;
  for (std::size_t c = 0; c < keys.size(); ++c) {
    std::uint64_t slot = (keys[c] * 0x9e3779b97f4a7c15u) >> shift_;
    while (table_[slot].cell != kNone) slot = (slot + 1) & mask_;
    table_[slot] = {keys[c], static_cast<std::uint32_t>(c)};
  }
}

std::uint64_t NeighbourGrid::keyOf(const Vec3& p) const {
  // From 1, so that the neighbours of the first cell have keys too; 21 bits an axis.
  const auto cell = [&](double v, double lower) {
    return static_cast<std::uint64_t>((v - lower) * inverseCell_) + 1;
  };
  return cell(p.x, lower_.x) * kStepX + cell(p.y, lower_.y) * kStepY + cell(p.z, lower_.z);
}

}  // namespace innermap
