#include "innermap/transfer/inverse_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/evaluate/detail/active_region.h"
#include "innermap/evaluate/evaluate_map.h"
#include "innermap/transfer/detail/cell_images.h"
#include "innermap/transfer/detail/leaf_index.h"
#include "innermap/transfer/detail/newton.h"

namespace innermap {
namespace {

constexpr double kInverted = 0.01;                       // target voxels
constexpr std::size_t kTogether = std::size_t{1} << 18;  // points of one Newton iteration
constexpr std::size_t kListed = 16;
constexpr double kLongestStep = 4;  // voxels of the source's lattice
// Of a voxel of the region while it is inverted.
constexpr std::uint64_t kVoxelBytes = sizeof(Vec3) + sizeof(std::array<float, 9>) + 24;

Vec3 toVec3(const openvdb::Vec3d& v) { return {v.x(), v.y(), v.z()}; }

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

  InvertedMap run(const openvdb::FloatGrid& targetLevelSet);
  NewtonResult solve(const Points& targets, Points& sources) const;

 private:
  void chooseRegion(const openvdb::FloatGrid& targetLevelSet, const LatticeImages& images);
  void dropUncovered(std::vector<LeafStarts>& starts);
  void number(InvertedMap& out) const;
  void invert(const openvdb::FloatGrid& targetLevelSet, const std::vector<LeafStarts>& starts,
              InvertedMap& out);
  void record(std::size_t i, const Vec3& target, bool inside, const NewtonResult& found,
              std::size_t n, InvertedMap& out);
  void fillFailures(InvertedMap& out);
  bool wanted(const openvdb::Coord& ijk) const { return solid_->tree().isValueOn(ijk); }

  const InverseSettings& settings_;
  const SourceLattice& lattice_;
  const openvdb::math::Transform& target_;
  double voxel_;
  ExtendedMap map_;
  openvdb::MaskGrid::Ptr solid_,
      region_;                          // of the target; with what is around it
  std::vector<std::bitset<512>> good_;  // inverted, of the region's leaves
};

void Inversion::chooseRegion(const openvdb::FloatGrid& targetLevelSet,
                             const LatticeImages& images) {
  RegionSettings region;
  region.skin = settings_.skin;
  region.bytesPerVoxel = kVoxelBytes;
  region.maxMemory = settings_.maxMemory;
  region.progress = settings_.progress;
  solid_ = activeRegion(targetLevelSet, region);
  region_ = solid_;
  if (!(settings_.outside.distance > 0)) return;
  const std::uint64_t most =
      settings_.maxMemory ? settings_.maxMemory / (512 * kVoxelBytes) : ~std::uint64_t{0};
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
  newton.progress = settings_.progress;
  return solveNewton(map_, targets, sources, newton);
}

void Inversion::record(std::size_t i, const Vec3& target, bool inside, const NewtonResult& found,
                       std::size_t n, InvertedMap& out) {
  InverseStatistics& s = out.statistics;
  const double residual = found.residuals[n] / voxel_;
  s.inside += inside;
  for (std::size_t k = 0; k < 9; ++k)
    out.jacobians[i][k] = static_cast<float>(found.at[n].jacobian[k / 3][k % 3]);
  if (residual <= kInverted) {
    ++s.inverted;
    s.largestResidual = std::max(s.largestResidual, residual);
    return;
  }
  ++s.failed;
  if (!inside) return;
  ++s.failedInside;
  s.failedBox.add(target);
  if (s.failedAt.size() < kListed) s.failedAt.push_back(target);
}

void Inversion::invert(const openvdb::FloatGrid& targetLevelSet,
                       const std::vector<LeafStarts>& starts, InvertedMap& out) {
  auto distance = targetLevelSet.getConstAccessor();
  out.sources.resize(out.first.back());
  out.jacobians.resize(out.first.back());
  good_.assign(starts.size(), {});
  const openvdb::math::Transform& source = lattice_.levelSet->transform();
  const LeafIndex leaves(region_->tree());
  std::size_t l = 0;
  while (l < leaves.size()) {
    const std::size_t begin = l;
    Points targets, sources;
    std::vector<LeafPlace> places;
    std::vector<char> inside;
    for (; l < leaves.size() && targets.size() < kTogether; ++l)
      for (auto voxel = leaves[l].cbeginValueOn(); voxel; ++voxel) {
        const openvdb::Index i = voxel.pos();
        targets.push_back(toVec3(target_.indexToWorld(voxel.getCoord())));
        sources.push_back(toVec3(source.indexToWorld(openvdb::Vec3d(starts[l].source[i]))));
        places.push_back({static_cast<std::uint32_t>(l), static_cast<std::uint16_t>(i)});
        inside.push_back(distance.getValue(voxel.getCoord()) < 0);
        if (!starts[l].covered[i]) ++out.statistics.uncovered;
      }
    const NewtonResult found = solve(targets, sources);
    for (std::size_t n = 0; n < targets.size(); ++n) {
      const std::size_t i = out.first[begin] + n;
      out.sources[i] = sources[n];
      record(i, targets[n], inside[n] != 0, found, n, out);
      good_[places[n].leaf].set(places[n].offset, found.residuals[n] <= kInverted * voxel_);
    }
    reportProgress(settings_.progress, "inverting the map",
                   static_cast<double>(l) / static_cast<double>(leaves.size()));
  }
  out.statistics.voxels = out.sources.size();
}

// A voxel that is not inverted becomes its nearest inverted neighbour's copy.
void Inversion::fillFailures(InvertedMap& out) {
  if (out.statistics.failed == 0) return;
  if (out.statistics.inverted == 0)
    throw DataError(
        "inverse: not one voxel of the target comes from the "
        "source; the map does not reach it, or "
        "the target lies elsewhere than the map's own");
  const LeafIndex leaves(region_->tree());
  std::vector<std::vector<std::uint16_t>> rank(leaves.size());
  const auto indexOf = [&](LeafPlace p) {
    std::vector<std::uint16_t>& r = rank[p.leaf];
    if (r.empty()) {
      r.assign(512, 0);
      std::uint16_t n = 0;
      for (auto voxel = leaves[p.leaf].cbeginValueOn(); voxel; ++voxel) r[voxel.pos()] = n++;
    }
    return out.first[p.leaf] + r[p.offset];
  };
  spreadToNeighbours(leaves, good_, [&](LeafPlace from, LeafPlace to) {
    out.sources[indexOf(to)] = out.sources[indexOf(from)];
    out.jacobians[indexOf(to)] = out.jacobians[indexOf(from)];
  });
}

InvertedMap Inversion::run(const openvdb::FloatGrid& targetLevelSet) {
  const LatticeImages images = imagesOf(map_, *lattice_.region, target_, settings_.progress);
  chooseRegion(targetLevelSet, images);
  std::vector<LeafStarts> starts = findStarts(images, *region_, settings_.progress);
  if (region_ != solid_) dropUncovered(starts);
  spreadStarts(*region_, starts);
  InvertedMap out;
  number(out);
  invert(targetLevelSet, starts, out);
  fillFailures(out);
  return out;
}

double shareInverted(std::uint64_t voxels, std::uint64_t failed) {
  return voxels ? 1 - static_cast<double>(failed) / static_cast<double>(voxels) : 1;
}

}  // namespace

void requireInRange(const InverseSettings& s) {
  if (!(s.tolerance >= 1e-6 && s.tolerance <= kInverted))
    throw SettingError("tolerance", "of the inverse must lie in [1e-6, 0.01] voxels");
  if (!(s.outside.distance >= 0 && s.outside.distance <= 1))
    throw SettingError("outside", "must lie in [0, 1] of the diagonal");
  if (!(s.accuracy >= 1e-12 && s.accuracy <= 1e-3))
    throw SettingError("accuracy", "must lie in [1e-12, 1e-3] of the target's extent");
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
      "{:.3g}% of the voxels inside come from nowhere in the source, the first near ({:.6g}, "
      "{:.6g}, {:.6g}); they have the values of their neighbours",
      100 * (1 - invertedInside()), at.x, at.y, at.z);
}

InvertedMap invertMap(const ComposedMap& map, const Solid& source, const SourceLattice& lattice,
                      const openvdb::FloatGrid& targetLevelSet, const InverseSettings& settings) {
  requireInRange(settings);
  return Inversion(map, source, lattice, targetLevelSet.transform(), settings).run(targetLevelSet);
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
