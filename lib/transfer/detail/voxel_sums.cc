#include "transfer/detail/voxel_sums.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "innermap/core/run.h"

namespace innermap {

void VoxelSums::add(std::vector<VoxelSums>& parts) {
  // By leaf, and then in the order of the parts.
  std::vector<std::pair<LeafSums*, const LeafSums*>> pairs;
  for (const VoxelSums& part : parts)
    for (const auto& [origin, sums] : part.leaves_) pairs.emplace_back(&leaves_[origin], &sums);
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::size_t> first;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (i == 0 || pairs[i].first != pairs[i - 1].first) first.push_back(i);
  first.push_back(pairs.size());
  parallelBlocks(first.size() - 1, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = first[begin]; i < first[end]; ++i)
      for (std::size_t n = 0; n < 512; ++n) {
        (*pairs[i].first)[n].volume += (*pairs[i].second)[n].volume;
        (*pairs[i].first)[n].mass += (*pairs[i].second)[n].mass;
      }
  });
  parts.clear();
}

}  // namespace innermap
