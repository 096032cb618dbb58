#include "transfer/detail/block_figures.h"

#include <algorithm>

#include "innermap/core/error.h"

namespace innermap {
namespace {

constexpr std::size_t kListed = 16;  // InverseStatistics::failedAt

// Where each number is kept: so those that are written are those that are read.
template <class Figures, class Visit>
void forCounts(Figures& s, const Visit& visit) {
  for (auto* count : {&s.voxels, &s.inverted, &s.uncovered, &s.failed, &s.inside, &s.failedInside})
    visit(*count);
}

template <class Figures, class Visit>
void forSums(Figures& f, const Visit& visit) {
  for (auto* number : {&f.inverse.largestResidual, &f.resampling.sum, &f.resampling.coarser,
                       &f.resampling.largestGrowth})
    visit(*number);
  for (int a = 0; a < 3; ++a) visit(f.inverse.failedBox.lower[a]);
  for (int a = 0; a < 3; ++a) visit(f.inverse.failedBox.upper[a]);
}

static_assert(kCarryNumbers == 6 + 4 + 6 + 1 + 3 * kListed);

}  // namespace

void CarryFigures::add(const CarryFigures& others) {
  InverseStatistics& s = inverse;
  const InverseStatistics& o = others.inverse;
  s.voxels += o.voxels;
  s.inverted += o.inverted;
  s.uncovered += o.uncovered;
  s.failed += o.failed;
  s.inside += o.inside;
  s.failedInside += o.failedInside;
  s.largestResidual = std::max(s.largestResidual, o.largestResidual);
  if (!o.failedBox.empty()) s.failedBox.add(o.failedBox);
  for (const Vec3& at : o.failedAt)
    if (s.failedAt.size() < kListed) s.failedAt.push_back(at);
  resampling.add(others.resampling);
}

ResamplingFigures voxelsOf(const openvdb::GridPtrVec& input, double outputVoxel) {
  ResamplingFigures out;
  out.inputVoxel = finestVoxel(input);
  out.outputVoxel = outputVoxel;
  return out;
}

CarryFigures& figuresAt(const openvdb::Coord& block, std::vector<BlockFigures>& blocks) {
  if (blocks.empty() || blocks.back().block != block) blocks.push_back({block, {}});
  return blocks.back().figures;
}

void requireNoOutside(const OutsideSettings& outside) {
  if (outside.distance > 0)
    throw SettingError("outside", "is not carried in shares; make the volume in one run");
}

BlockSums sumsOf(const BlockFigures& block) {
  BlockSums out{block.block, {}};
  std::vector<double>& numbers = out.numbers;
  const CarryFigures& f = block.figures;
  forCounts(f.inverse, [&](std::uint64_t n) { numbers.push_back(static_cast<double>(n)); });
  forSums(f, [&](double n) { numbers.push_back(n); });
  const Points& at = f.inverse.failedAt;
  numbers.push_back(static_cast<double>(at.size()));
  for (const Vec3& p : at)
    for (int a = 0; a < 3; ++a) numbers.push_back(p[a]);
  numbers.resize(kCarryNumbers);
  return out;
}

CarryFigures figuresOf(const std::vector<double>& numbers) {
  CarryFigures out;
  auto next = numbers.begin();
  forCounts(out.inverse, [&](std::uint64_t& n) {
    n = static_cast<std::uint64_t>(std::clamp(*next++, 0.0, 9e15));
  });
  forSums(out, [&](double& n) { n = *next++; });
  const auto count = static_cast<std::size_t>(std::clamp(*next++, 0.0, 1.0 * kListed));
  for (std::size_t i = 0; i < count; ++i, next += 3)
    out.inverse.failedAt.push_back({next[0], next[1], next[2]});
  return out;
}

CarryFigures sumOf(const GridBlocks& blocks, const ResamplingFigures& voxels) {
  CarryFigures out;
  out.resampling = voxels;
  for (const BlockSums& block : blocks.sums()) out.add(figuresOf(block.numbers));
  return out;
}

}  // namespace innermap
