#include <openvdb/tree/LeafManager.h>

#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/levelset/level_set.h"

namespace innermap {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using openvdb::FloatTree;

// Share of the unit cube below the plane m . x = alpha, for 0 <= m1 <= m2 <= m3 with sum 1 and
// alpha in [0, 1/2].
double lowerFraction(double m1, double m2, double m3, double alpha) {
  // Below this the cubic terms cancel to noise and a plane parallel to an axis is as exact.
  if (m1 < 1e-6) {
    if (alpha < m2) return alpha * alpha / (2 * m2 * m3);
    return (2 * alpha - m2) / (2 * m3);
  }
  const double m12 = m1 + m2;
  if (alpha < m1) return alpha * alpha * alpha / (6 * m1 * m2 * m3);
  if (alpha < m2) return alpha * (alpha - m1) / (2 * m2 * m3) + m1 * m1 / (6 * m2 * m3);
  if (alpha >= m12 && m12 <= m3) return (2 * alpha - m12) / (2 * m3);
  double sum = m1 * m1 * (m1 - 3 * alpha) + m2 * m2 * (m2 - 3 * alpha);
  if (alpha < m3) {
    sum += alpha * alpha * (3 * m12 - alpha);
  } else {
    sum += alpha * alpha * (3 - 2 * alpha) + m3 * m3 * (m3 - 3 * alpha);
  }
  return sum / (6 * m1 * m2 * m3);
}

// Distances beyond this cannot cut a cell: half the diagonal of the unit cube.
constexpr double kReach = 0.8660254037844387;

float fractionAt(const openvdb::tree::ValueAccessor<const FloatTree>& values, const Coord& c,
                 double value, double voxelSize) {
  const double distance = value / voxelSize;
  if (distance >= kReach) return 0;
  if (distance <= -kReach) return 1;
  Vec3 gradient;
  for (int a = 0; a < 3; ++a) {
    Coord before = c, after = c;
    --before[a];
    ++after[a];
    gradient[a] = 0.5 * (double(values.getValue(after)) - values.getValue(before)) / voxelSize;
  }
  // Where sheets face each other the gradient vanishes; then the cell is taken as cut by a plane
  // along an axis.
  const double length = norm(gradient);
  const Vec3 normal = length > 0.1 ? gradient / length : Vec3{1, 0, 0};
  return static_cast<float>(cellFraction(distance, normal));
}

void requireLevelSet(const FloatGrid& levelSet) {
  if (levelSet.getGridClass() != openvdb::GRID_LEVEL_SET || !levelSet.hasUniformVoxels()) {
    throw DataError("grid " + levelSet.getName() +
                    ": is not a level set of cubic voxels; make one with voxelize");
  }
}

}  // namespace

double cellFraction(double distance, const Vec3& normal) {
  std::array<double, 3> m{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
  const double sum = m[0] + m[1] + m[2];
  if (!(sum > 0)) return distance < 0 ? 1 : 0;
  std::sort(m.begin(), m.end());
  const double alpha = 0.5 - distance / sum;
  if (!(alpha > 0)) return 0;
  if (alpha >= 1) return 1;
  for (double& v : m) v /= sum;
  const double lower = lowerFraction(m[0], m[1], m[2], std::min(alpha, 1 - alpha));
  return std::clamp(alpha <= 0.5 ? lower : 1 - lower, 0.0, 1.0);
}

FloatGrid::Ptr makeFog(const FloatGrid& levelSet) {
  requireLevelSet(levelSet);
  const double h = levelSet.voxelSize()[0];
  FloatGrid::Ptr fog = levelSet.deepCopy();
  FloatTree& tree = fog->tree();
  openvdb::tree::LeafManager<FloatTree> leaves(tree);
  parallelBlocks(leaves.leafCount(), 16, [&](std::size_t begin, std::size_t end) {
    openvdb::tree::ValueAccessor<const FloatTree> values(levelSet.tree());
    for (std::size_t l = begin; l < end; ++l) {
      auto& leaf = leaves.leaf(l);
      for (openvdb::Index i = 0; i < leaf.SIZE; ++i) {
        const float f = fractionAt(values, leaf.offsetToGlobalCoord(i), leaf.getValue(i), h);
        leaf.setValueOnly(i, f);
        leaf.setActiveState(i, f > 0);
      }
    }
  });
  tree.root().setBackground(0, false);
  auto tile = tree.beginValueAll();
  tile.setMaxDepth(FloatTree::ValueAllIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    const bool inside = tile.getValue() < 0;
    tile.setValue(inside ? 1.0f : 0.0f);
    tile.setActiveState(inside);
  }
  tree.prune();
  fog->setGridClass(openvdb::GRID_FOG_VOLUME);
  fog->setName("density");
  return fog;
}

double insideVolume(const FloatGrid& levelSet) {
  requireLevelSet(levelSet);
  const double h = levelSet.voxelSize()[0];
  const openvdb::tree::LeafManager<const FloatTree> leaves(levelSet.tree());
  std::vector<double> sums(leaves.leafCount());
  parallelBlocks(sums.size(), 16, [&](std::size_t begin, std::size_t end) {
    openvdb::tree::ValueAccessor<const FloatTree> values(levelSet.tree());
    for (std::size_t l = begin; l < end; ++l) {
      const auto& leaf = leaves.leaf(l);
      for (openvdb::Index i = 0; i < leaf.SIZE; ++i)
        sums[l] += double(fractionAt(values, leaf.offsetToGlobalCoord(i), leaf.getValue(i), h));
    }
  });
  double voxels = std::accumulate(sums.begin(), sums.end(), 0.0);
  auto tile = levelSet.tree().cbeginValueAll();
  tile.setMaxDepth(FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile)
    if (*tile < 0) voxels += static_cast<double>(tile.getVoxelCount());
  return voxels * std::pow(h, 3);
}

}  // namespace innermap
