#include "innermap/transfer/inverse_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/require_number.h"
#include "evaluate/active_region.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/evaluate/evaluate_map.h"
#include "transfer/detail/cell_images.h"
#include "transfer/detail/invert_block.h"
#include "transfer/detail/leaf_index.h"
#include "transfer/detail/newton.h"
#include "transfer/detail/step_by_step.h"

namespace innermap {
namespace {

constexpr double kInvertedVoxels = 0.01;                         // target voxels
constexpr std::size_t kInvertedTogether = std::size_t{1} << 18;  // points of one Newton iteration
constexpr std::size_t kListed = 16;
constexpr int kRounds = 3;          // of starts from neighbours
constexpr double kLongestStep = 4;  // voxels of the source's lattice
// Of a voxel of the region while it is inverted.
constexpr std::uint64_t kVoxelBytes = sizeof(Vec3) + sizeof(std::array<float, 9>) + 24;

Vec3 toVec3(const openvdb::Vec3d& v) { return {v.x(), v.y(), v.z()}; }

// Voxels that are inverted together.
struct Batch {
  Points targets, sources;
  std::vector<LeafPlace> places;
  std::vector<std::size_t> index;  // among all voxels

  void add(const Vec3& target, const Vec3& start, LeafPlace place, std::size_t i) {
    targets.push_back(target);
    sources.push_back(start);
    places.push_back(place);
    index.push_back(i);
  }
};

LeafPlace placeOf(std::size_t leaf, openvdb::Index offset) {
  return {static_cast<std::uint32_t>(leaf), static_cast<std::uint16_t>(offset)};
}

class Inversion {
 public:
  Inversion(const ComposedMap& map, const Solid& source, const SourceLattice& lattice,
            const openvdb::math::Transform& target, const InverseSettings& settings)
      : settings_(settings),
        lattice_(lattice),
        target_(target),
        voxel_(target.voxelSize()[0]),
        map_(map, source, *lattice.levelSet, settings.outside,
             std::min(settings.accuracy * targetExtent(map, source),
                      0.1 * settings.tolerance * voxel_)) {}

  LatticeImages images() const { return imagesOf(map_, *lattice_.region, target_); }
  InvertedMap run(const openvdb::FloatGrid& targetLevelSet, const LatticeImages& images);
  NewtonResult solve(const Points& targets, Points& sources) const;

 private:
  void chooseRegion(const openvdb::FloatGrid& targetLevelSet, const LatticeImages& images);
  void dropUncovered(std::vector<LeafStarts>& starts);
  void number(InvertedMap& out) const;
  void invertBlock(const LeafIndex& leaves, LeafStarts* starts,
                   const openvdb::FloatGrid& targetLevelSet, InvertedMap& out);
  void invert(const LeafIndex& leaves, const LeafStarts* starts, InvertedMap& out);
  std::size_t invertFailures(const LeafIndex& leaves, const openvdb::FloatGrid& targetLevelSet,
                             bool stepByStep, InvertedMap& out);
  std::size_t solve(Batch& batch, InvertedMap& out);
  void fillFailures(const LeafIndex& leaves, InvertedMap& out) const;
  void count(const LeafIndex& leaves, const openvdb::FloatGrid& targetLevelSet,
             InverseStatistics& s) const;
  bool wanted(const openvdb::Coord& ijk) const { return solid_->tree().isValueOn(ijk); }

  const InverseSettings& settings_;
  const SourceLattice& lattice_;
  const openvdb::math::Transform& target_;
  double voxel_;
  ExtendedMap map_;
  openvdb::MaskGrid::Ptr solid_,
      region_;  // of the target; with what is around it
  // The block of voxels that is inverted: by itself, so that what its voxels get does not depend on
  // which others there are. Its first leaf among all, and which voxels are inverted.
  std::size_t begin_ = 0;
  std::vector<std::bitset<512>> good_;
};

void Inversion::chooseRegion(const openvdb::FloatGrid& targetLevelSet,
                             const LatticeImages& images) {
  RegionSettings region;
  region.skin = settings_.skin;
  region.bytesPerVoxel = kVoxelBytes;
  solid_ = activeRegion(targetLevelSet, region);
  region_ = solid_;
  if (!(settings_.outside.distance > 0)) return;
  const std::uint64_t most = memoryLimit() / (512 * kVoxelBytes);
  const double reach = map_.endless() ? std::numeric_limits<double>::infinity() : map_.reach();
  region_ = touchedLeaves(images, reach, most);
  region_->setTransform(target_.copy());
  region_->tree().topologyUnion(solid_->tree());
}

// Voxels around the solid that nothing comes to are none of the region's.
void Inversion::dropUncovered(std::vector<LeafStarts>& starts) {
  const double reach = map_.endless() ? std::numeric_limits<double>::infinity() : map_.reach();
  std::size_t l = 0;
  for (auto leaf = region_->tree().beginLeaf(); leaf; ++leaf, ++l)
    for (auto voxel = leaf->beginValueOn(); voxel; ++voxel) {
      const openvdb::Index i = voxel.pos();
      if (!(starts[l].covered[i] && starts[l].outside[i] <= reach) && !wanted(voxel.getCoord()))
        leaf->setValueOff(i);
    }
}

void Inversion::number(InvertedMap& out) const {
  out.region = region_;
  out.first.assign(1, 0);
  for (auto leaf = region_->tree().cbeginLeaf(); leaf; ++leaf)
    out.first.push_back(out.first.back() + leaf->onVoxelCount());
}

NewtonResult Inversion::solve(const Points& targets, Points& sources) const {
  NewtonSettings newton;
  newton.tolerance = settings_.tolerance * voxel_;
  newton.longestStep = kLongestStep * lattice_.levelSet->voxelSize()[0];
  return solveNewton(map_, targets, sources, newton);
}

void Inversion::invert(const LeafIndex& leaves, const LeafStarts* starts, InvertedMap& out) {
  good_.assign(leaves.size(), {});
  const openvdb::math::Transform& source = lattice_.levelSet->transform();
  std::size_t l = 0;
  while (l < leaves.size()) {
    Batch batch;
    for (; l < leaves.size() && batch.targets.size() < kInvertedTogether; ++l) {
      std::size_t i = out.first[begin_ + l];
      for (auto voxel = leaves[l].cbeginValueOn(); voxel; ++voxel, ++i) {
        const openvdb::Vec3d start(starts[l].source[voxel.pos()]);
        batch.add(toVec3(target_.indexToWorld(voxel.getCoord())),
                  toVec3(source.indexToWorld(start)), placeOf(l, voxel.pos()), i);
        if (!starts[l].covered[voxel.pos()]) ++out.statistics.uncovered;
      }
    }
    solve(batch, out);
    reportProgress("inverting the map",
                   static_cast<double>(begin_ + l) / static_cast<double>(out.first.size() - 1));
  }
}

// The number that is inverted.
std::size_t Inversion::solve(Batch& batch, InvertedMap& out) {
  const NewtonResult found = solve(batch.targets, batch.sources);
  std::size_t inverted = 0;
  for (std::size_t n = 0; n < batch.targets.size(); ++n) {
    const std::size_t i = batch.index[n];
    out.sources[i] = batch.sources[n];
    for (std::size_t k = 0; k < 9; ++k)
      out.jacobians[i][k] = static_cast<float>(found.at[n].jacobian[k / 3][k % 3]);
    const double residual = found.residuals[n] / voxel_;
    if (!(residual <= kInvertedVoxels)) continue;
    out.statistics.largestResidual = std::max(out.statistics.largestResidual, residual);
    good_[batch.places[n].leaf].set(batch.places[n].offset);
    ++inverted;
  }
  return inverted;
}

// A voxel that is not inverted becomes its nearest inverted neighbour's copy.
void Inversion::fillFailures(const LeafIndex& leaves, InvertedMap& out) const {
  std::vector<std::vector<std::uint16_t>> rank(leaves.size());
  const auto indexOf = [&](LeafPlace p) {
    std::vector<std::uint16_t>& r = rank[p.leaf];
    if (r.empty()) {
      r.assign(512, 0);
      std::uint16_t n = 0;
      for (auto voxel = leaves[p.leaf].cbeginValueOn(); voxel; ++voxel) r[voxel.pos()] = n++;
    }
    return out.first[begin_ + p.leaf] + r[p.offset];
  };
  std::vector<std::bitset<512>> has = good_;
  spreadToNeighbours(leaves, has, [&](LeafPlace from, LeafPlace to) {
    out.sources[indexOf(to)] = out.sources[indexOf(from)];
    out.jacobians[indexOf(to)] = out.jacobians[indexOf(from)];
  });
}

// Voxels inside once more, from the sources of inverted neighbours or what is found step by step
// from these: the number that is inverted by that. (Those outside mostly have no source: the map
// ends at the surface.)
std::size_t Inversion::invertFailures(const LeafIndex& leaves,
                                      const openvdb::FloatGrid& targetLevelSet, bool stepByStep,
                                      InvertedMap& out) {
  auto distance = targetLevelSet.getConstAccessor();
  Batch batch;
  for (std::size_t l = 0; l < leaves.size(); ++l) {
    std::size_t i = out.first[begin_ + l];
    for (auto voxel = leaves[l].cbeginValueOn(); voxel; ++voxel, ++i)
      if (!good_[l][voxel.pos()] && distance.getValue(voxel.getCoord()) < 0)
        batch.add(toVec3(target_.indexToWorld(voxel.getCoord())), out.sources[i],
                  placeOf(l, voxel.pos()), i);
  }
  if (stepByStep) {
    if (batch.targets.size() > kMostStepByStep) return 0;
    batch.sources = invertStepByStep(map_.harmonic(), batch.targets, batch.sources,
                                     {settings_.tolerance * voxel_});
  }
  const std::size_t inverted = solve(batch, out);
  fillFailures(leaves, out);
  return inverted;
}

void Inversion::count(const LeafIndex& leaves, const openvdb::FloatGrid& targetLevelSet,
                      InverseStatistics& s) const {
  auto distance = targetLevelSet.getConstAccessor();
  for (std::size_t l = 0; l < leaves.size(); ++l)
    for (auto voxel = leaves[l].cbeginValueOn(); voxel; ++voxel) {
      const bool inside = distance.getValue(voxel.getCoord()) < 0;
      ++s.voxels;
      s.inside += inside;
      if (good_[l][voxel.pos()]) {
        ++s.inverted;
        continue;
      }
      ++s.failed;
      if (!inside) continue;
      ++s.failedInside;
      const Vec3 target = toVec3(target_.indexToWorld(voxel.getCoord()));
      s.failedBox.add(target);
      if (s.failedAt.size() < kListed) s.failedAt.push_back(target);
    }
}

void Inversion::invertBlock(const LeafIndex& leaves, LeafStarts* starts,
                            const openvdb::FloatGrid& targetLevelSet, InvertedMap& out) {
  spreadStarts(leaves, starts);
  invert(leaves, starts, out);
  fillFailures(leaves, out);
  const auto again = [&](bool stepByStep) {
    return invertFailures(leaves, targetLevelSet, stepByStep, out) > 0;
  };
  for (int round = 0; round < kRounds && again(false); ++round) continue;
  if (map_.harmonic().steps().size() > 1)
    for (int round = 0; round < kRounds && again(true); ++round) continue;
  count(leaves, targetLevelSet, out.statistics);
}

InvertedMap Inversion::run(const openvdb::FloatGrid& targetLevelSet, const LatticeImages& images) {
  chooseRegion(targetLevelSet, images);
  std::vector<LeafStarts> starts = findStarts(images, *region_);
  if (region_ != solid_) dropUncovered(starts);
  InvertedMap out;
  number(out);
  out.sources.resize(out.first.back());
  out.jacobians.resize(out.first.back());
  std::vector<const LeafIndex::Leaf*> block;
  begin_ = 0;
  for (auto leaf = region_->tree().cbeginLeaf(); leaf;) {
    block.push_back(leaf.getLeaf());
    ++leaf;
    if (leaf && blockOf(leaf->origin()) == blockOf(block.front()->origin())) continue;
    invertBlock(LeafIndex(block), starts.data() + begin_, targetLevelSet, out);
    begin_ += block.size();
    block.clear();
  }
  return out;
}

InvertedMap invertPointwise(const SolidMap::Pointwise& map,
                            const openvdb::FloatGrid& targetLevelSet,
                            const InverseSettings& settings) {
  constexpr std::size_t kLeaves = 8;  // that a thread looks at together
  InvertedMap out;
  out.region = activeRegion(targetLevelSet, {settings.skin, kVoxelBytes});
  std::vector<const openvdb::MaskTree::LeafNodeType*> leaves;
  out.region->tree().getNodes(leaves);
  out.first = {0};
  for (const auto* leaf : leaves) out.first.push_back(out.first.back() + leaf->onVoxelCount());
  out.sources.resize(out.first.back());
  out.jacobians.resize(out.first.back());
  parallelBlocks(
      leaves.size(), kLeaves,
      [&](std::size_t begin, std::size_t end) {
        std::size_t i = out.first[begin];
        for (std::size_t l = begin; l < end; ++l)
          for (auto voxel = leaves[l]->cbeginValueOn(); voxel; ++voxel, ++i) {
            const PointImage s = map.pull(toVec3(out.region->indexToWorld(voxel.getCoord())));
            out.sources[i] = s.image;
            const Mat3 jacobian = inverse(s.jacobian);
            for (std::size_t k = 0; k < 9; ++k)
              out.jacobians[i][k] = static_cast<float>(jacobian[k / 3][k % 3]);
          }
      },
      "carrying voxels");
  out.statistics.voxels = out.statistics.inverted = out.first.back();
  return out;
}

double shareInverted(std::uint64_t voxels, std::uint64_t failed) {
  return voxels ? 1 - static_cast<double>(failed) / static_cast<double>(voxels) : 1;
}

}  // namespace

void requireInRange(const InverseSettings& s) {
  requireNumber("tolerance", s.tolerance, {1e-6, kInvertedVoxels}, "voxels");
  requireNumber("outside", s.outside.distance, {0, 1}, "of the diagonal");
  requireNumber("accuracy", s.accuracy, {1e-12, 1e-3}, "of the target's extent");
}

double InverseStatistics::invertedInside() const { return shareInverted(inside, failedInside); }

double InverseStatistics::invertedOutside() const {
  return shareInverted(voxels - inside, failed - failedInside);
}

std::string InverseStatistics::warning() const {
  constexpr double kMany = 0.005;
  if (failedAt.empty() || 1 - invertedInside() <= kMany) return {};
  const Vec3& at = failedAt.front();
  return fmt::format(
      "{:.3g}% of the voxels inside have no origin in the source, the first near ({:.6g}, {:.6g}, "
      "{:.6g}); they take the values of their neighbours",
      100 * (1 - invertedInside()), at.x, at.y, at.z);
}

InvertedMap invertMap(const SolidMap& map, const Solid& source, const SourceLattice& lattice,
                      const openvdb::FloatGrid& targetLevelSet, const InverseSettings& settings) {
  requireInRange(settings);
  if (map.pointwise()) return invertPointwise(*map.pointwise(), targetLevelSet, settings);
  Inversion inversion(*map.harmonic(), source, lattice, targetLevelSet.transform(), settings);
  InvertedMap out = inversion.run(targetLevelSet, inversion.images());
  requireInverted(out.statistics);
  return out;
}

void requireInverted(const InverseStatistics& statistics) {
  if (statistics.voxels > 0 && statistics.inverted == 0)
    throw DataError(
        "inverse: not one voxel of the target comes from the source; the map does not reach it, or "
        "the target lies elsewhere than the map's own");
}

LatticeImages imagesOf(const ComposedMap& map, const Solid& source, const SourceLattice& lattice,
                       const openvdb::math::Transform& target, const InverseSettings& settings) {
  requireInRange(settings);
  return Inversion(map, source, lattice, target, settings).images();
}

InvertedMap invertBlock(const ComposedMap& map, const Solid& source, const SourceLattice& lattice,
                        const LatticeImages& images, const openvdb::FloatGrid& targetLevelSet,
                        const InverseSettings& settings) {
  return Inversion(map, source, lattice, targetLevelSet.transform(), settings)
      .run(targetLevelSet, images);
}

Points invertAt(const ComposedMap& map, const Solid& source, const SourceLattice& lattice,
                const InvertedMap& inverted, const Points& targets,
                const InverseSettings& settings) {
  requireInRange(settings);
  const openvdb::math::Transform& target = inverted.region->transform();
  const LeafIndex leaves(inverted.region->tree());
  Points out = targets, wanted, sources;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const openvdb::Vec3d q(targets[i].x, targets[i].y, targets[i].z);
    const openvdb::Coord ijk = target.worldToIndexNodeCentered(q);
    const std::uint32_t leaf = leaves.find(ijk);
    if (leaf == LeafIndex::kNone || !leaves[leaf].isValueOn(ijk)) continue;
    std::size_t n = inverted.first[leaf];
    for (auto voxel = leaves[leaf].cbeginValueOn(); voxel.getCoord() != ijk; ++voxel) ++n;
    index.push_back(i);
    wanted.push_back(targets[i]);
    sources.push_back(inverted.sources[n]);
  }
  Inversion(map, source, lattice, target, settings).solve(wanted, sources);
  for (std::size_t n = 0; n < index.size(); ++n) out[index[n]] = sources[n];
  return out;
}

}  // namespace innermap
