#include "sample/detail/neighbour_grid.h"

#include <tbb/parallel_sort.h>

#include <algorithm>

#include "innermap/core/run.h"

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
  cellOf_.reserve(points.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (i == 0 || entries[i].key != entries[i - 1].key) {
      starts_.push_back(static_cast<std::uint32_t>(i));
      keys_.push_back(entries[i].key);
    }
    points_.push_back(points[entries[i].index]);
    index_.push_back(entries[i].index);
    cellOf_.push_back(static_cast<std::uint32_t>(keys_.size() - 1));
  }
  starts_.push_back(static_cast<std::uint32_t>(points.size()));
  findRows();
}

void NeighbourGrid::findRows() {
  rows_.resize(keys_.size());
  parallelBlocks(keys_.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (int row = 0; row < 9; ++row) {
      const std::uint64_t offset = static_cast<std::uint64_t>(row / 3 - 1) * kStepX +
                                   static_cast<std::uint64_t>(row % 3 - 1) * kStepY;
      const std::uint64_t lowest = keys_[begin] + offset - 1;
      std::size_t first = static_cast<std::size_t>(
          std::lower_bound(keys_.begin(), keys_.end(), lowest) - keys_.begin());
      std::size_t last = first;
      // Keys ascend, so both ends only move up.
      for (std::size_t c = begin; c < end; ++c) {
        const std::uint64_t middle = keys_[c] + offset;
        while (first < keys_.size() && keys_[first] < middle - 1) ++first;
        last = std::max(first, last);
        while (last < keys_.size() && keys_[last] <= middle + 1) ++last;
        rows_[c][static_cast<std::size_t>(row)] = {starts_[first], starts_[last]};
      }
    }
  });
}

std::vector<std::vector<std::uint32_t>> NeighbourGrid::cubes(int log2Width) const {
  const std::uint64_t axis = kStepY - (std::uint64_t(1) << log2Width);
  const std::uint64_t mask = axis | axis << kBits | axis << 2 * kBits;
  struct Entry {
    std::uint64_t cube;
    std::uint32_t cell;
  };
  std::vector<Entry> entries(keys_.size());
  for (std::size_t c = 0; c < keys_.size(); ++c)
    entries[c] = {keys_[c] & mask, static_cast<std::uint32_t>(c)};
  tbb::parallel_sort(entries.begin(), entries.end(), [](const Entry& x, const Entry& y) {
    return x.cube < y.cube || (x.cube == y.cube && x.cell < y.cell);
  });
  std::vector<std::vector<std::uint32_t>> out;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (i == 0 || entries[i].cube != entries[i - 1].cube) out.emplace_back();
    out.back().push_back(entries[i].cell);
  }
  return out;
}

std::uint64_t NeighbourGrid::keyOf(const Vec3& p) const {
  // From 1, so that the neighbours of the first cell have keys too; 21 bits an axis.
  const auto cell = [&](double v, double lower) {
    return static_cast<std::uint64_t>((v - lower) * inverseCell_) + 1;
  };
  return cell(p.x, lower_.x) * kStepX + cell(p.y, lower_.y) * kStepY + cell(p.z, lower_.z);
}

}  // namespace innermap
