#include "transfer/detail/density_voxels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "evaluate/extended_places.h"
#include "evaluate/topology.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

using openvdb::Coord;
using Leaf = openvdb::MaskTree::LeafNodeType;

constexpr double kEndless = std::numeric_limits<double>::infinity();

template <class Visit>
auto asScalars(const openvdb::GridBase& grid, const Visit& visit) {
  if (grid.isType<openvdb::FloatGrid>()) return visit(static_cast<const openvdb::FloatGrid&>(grid));
  return visit(static_cast<const openvdb::DoubleGrid&>(grid));
}

template <class Grid>
class ScalarReader : public DensityReader {
 public:
  ScalarReader(const Grid& grid, bool constant) : accessor_(grid.tree()), constant_(constant) {}

  LinearDensity at(const Coord& voxel) const override {
    LinearDensity out{value(voxel), {}};
    if (constant_) return out;
    std::array<double, 27> v;
    for (int n = 0; n < 27; ++n)
      v[static_cast<std::size_t>(n)] = value(voxel.offsetBy(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1));
    const auto [lower, upper] = std::minmax_element(v.begin(), v.end());
    out.slope = 0.5 * Vec3{v[22] - v[4], v[16] - v[10], v[14] - v[12]};
    const double rise =
        0.5 * (std::abs(out.slope.x) + std::abs(out.slope.y) + std::abs(out.slope.z));
    const double room = std::min(*upper - out.mean, out.mean - *lower);
    if (rise > room) out.slope = (room / rise) * out.slope;
    return out;
  }

 private:
  double value(const Coord& ijk) const { return static_cast<double>(accessor_.getValue(ijk)); }

  openvdb::tree::ValueAccessor<const typename Grid::TreeType, false> accessor_;
  bool constant_;
};

Vec3 toVec3(const openvdb::Vec3d& v) { return {v.x(), v.y(), v.z()}; }

double voxelVolume(const openvdb::GridBase& grid) {
  return std::abs(grid.transform().baseMap()->determinant());
}

// World units, the longest of the four.
double halfDiagonal(const openvdb::math::Transform& transform) {
  const Vec3 origin = toVec3(transform.indexToWorld(openvdb::Vec3d(0)));
  double longest = 0;
  for (const openvdb::Vec3d& corner : {openvdb::Vec3d(1, 1, 1), openvdb::Vec3d(-1, 1, 1),
                                       openvdb::Vec3d(1, -1, 1), openvdb::Vec3d(1, 1, -1)})
    longest = std::max(longest, norm(toVec3(transform.indexToWorld(corner)) - origin));
  return 0.5 * longest;
}

// How far outside the solid the centres of carried voxels may be, world units.
double marginOf(const openvdb::GridBase& grid, const Solid& solid, const OutsideSettings& outside) {
  if (outside.distance > 0 && outside.fadeTo) return kEndless;
  const double touching =
      grid.getGridClass() == openvdb::GRID_FOG_VOLUME ? halfDiagonal(grid.transform()) : 0;
  return std::max(touching, outside.distance * solid.diagonal());
}

// Voxels whose centre is in the box or near it.
openvdb::CoordBBox indicesOf(const Box3& box, const openvdb::math::Transform& transform) {
  constexpr double kFarthest = 1e9;
  openvdb::CoordBBox out;
  for (int corner = 0; corner < 8; ++corner) {
    const openvdb::Vec3d ijk = transform.worldToIndex(openvdb::Vec3d(
        corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
        corner & 4 ? box.upper.z : box.lower.z));
    for (const double way : {-1.0, 1.0}) {
      Coord at;
      for (int a = 0; a < 3; ++a)
        at[a] = static_cast<int>(std::clamp(std::floor(ijk[a]) + way, -kFarthest, kFarthest));
      out.expand(at);
    }
  }
  return out;
}

// Whether points are inside the solid or within the margin of it.
class Carried {
 public:
  Carried(const Solid& solid, const openvdb::FloatGrid& levelSet, double margin)
      : solid_(solid), side_(solid, levelSet), margin_(margin) {}

  bool operator()(const Vec3& p) const {
    if (margin_ == kEndless) return true;
    const int sign = side_.sure(p);
    if (sign != 0 && (sign < 0 || !(margin_ > 0))) return sign < 0;
    const Solid::Closest closest = solid_.closest(p, sign == 0 ? kEndless : margin_);
    if (closest.onSurface.triangle >= 0 && closest.distance <= margin_) return true;
    return sign == 0 && side_.inside(p, closest);
  }

 private:
  const Solid& solid_;
  SideOfSurface side_;
  double margin_;
};

// Switches off what is not carried; the sum of what is.
template <class Grid>
double keepCarried(openvdb::MaskTree& active, const Grid& grid, const Solid& solid,
                   const openvdb::FloatGrid& levelSet, double margin) {
  std::vector<Leaf*> leaves;
  active.getNodes(leaves);
  std::vector<double> sums(leaves.size(), 0);
  parallelBlocks(
      leaves.size(), 8,
      [&](std::size_t begin, std::size_t end) {
        const Carried carried(solid, levelSet, margin);
        const openvdb::tree::ValueAccessor<const typename Grid::TreeType, false> at(grid.tree());
        for (std::size_t l = begin; l < end; ++l)
          for (auto voxel = leaves[l]->beginValueOn(); voxel; ++voxel) {
            const auto value = static_cast<double>(at.getValue(voxel.getCoord()));
            if (value != 0 && carried(toVec3(grid.transform().indexToWorld(voxel.getCoord()))))
              sums[l] += value;
            else
              leaves[l]->setValueOff(voxel.pos());
          }
      },
      "finding the inside");
  double sum = 0;
  for (const double s : sums) sum += s;
  return sum;
}

}  // namespace

openvdb::MaskTree activeNear(const openvdb::GridBase& grid, const Solid& solid,
                             const OutsideSettings& outside) {
  if (!grid.transform().isLinear())
    throw DataError("density \"" + grid.getName() +
                    "\": has a frustum for transform; resample it to voxels of one size");
  const double margin = marginOf(grid, solid, outside);
  openvdb::MaskTree active = activeTopology(grid);
  if (!(margin < kEndless)) return active;
  Box3 box = solid.box();
  box.add(box.upper + Vec3{margin, margin, margin});
  box.add(box.lower - Vec3{margin, margin, margin});
  openvdb::MaskTree within;
  within.fill(indicesOf(box, grid.transform()), true, true);
  active.topologyIntersection(within);
  return active;
}

DensityVoxels densityVoxels(const openvdb::GridBase::ConstPtr& grid, const Solid& solid,
                            const openvdb::FloatGrid& levelSet, const OutsideSettings& outside) {
  const double margin = marginOf(*grid, solid, outside);
  auto active = std::make_shared<openvdb::MaskTree>(activeNear(*grid, solid, outside));
  requireMemory("the density \"" + grid->getName() + "\"", active->activeVoxelCount() / 4,
                "cut the volume off around the solid");
  active->voxelizeActiveTiles();
  DensityVoxels out;
  out.grid = grid;
  asScalars(*grid, [&](const auto& typed) {
    out.mass = keepCarried(*active, typed, solid, levelSet, margin);
  });
  out.mass *= voxelVolume(*grid);
  out.left = massOf(*grid) - out.mass;
  out.carried = active;
  return out;
}

std::unique_ptr<DensityReader> readerOf(const openvdb::GridBase& grid, bool constant) {
  return asScalars(grid, [&](const auto& typed) -> std::unique_ptr<DensityReader> {
    return std::make_unique<ScalarReader<std::decay_t<decltype(typed)>>>(typed, constant);
  });
}

double massOf(const openvdb::GridBase& grid) {
  return asScalars(grid, [&](const auto& typed) {
    double total = 0;
    for (auto value = typed.cbeginValueOn(); value; ++value)
      total += static_cast<double>(*value) * static_cast<double>(value.getVoxelCount());
    return total * voxelVolume(grid);
  });
}

}  // namespace innermap
