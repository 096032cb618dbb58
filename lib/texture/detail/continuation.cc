#include "texture/detail/continuation.h"

#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <cmath>

#include "core/pi.h"
#include "core/require_number.h"
#include "evaluate/active_region.h"
#include "evaluate/visit_field.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

using openvdb::Vec3fGrid;
using Leaf = openvdb::Vec3STree::LeafNodeType;
using MaskLeaves = openvdb::tree::LeafManager<const openvdb::MaskTree>;

constexpr double kReach = 1.5;                 // spacings; 1% of the rest is left there
constexpr double kExactDepth = 1;              // voxels: what interpolation at the surface sees
constexpr std::size_t kLeavesTogether = 2048;  // bounds the memory for points
constexpr double kLeafRadius = 6.1;            // voxels, from the middle of a leaf to its corners

double factorAt(double depth, double spacing) {
  if (depth <= 0) return 1;
  const double end = std::exp(-kPi * kReach);
  return std::max(0.0, (std::exp(-kPi * depth / spacing) - end) / (1 - end));
}

// A voxel near the boundary.
struct Near {
  std::size_t leaf = 0;
  openvdb::Index offset = 0;
  double factor = 1;
  Solid::Closest closest;
  bool outside = false;
  std::size_t row = 0;  // of the field's value at the closest point, where it is wanted
};

class Continuation {
 public:
  Continuation(const HarmonicField& field, const Solid& solid, const openvdb::FloatGrid& levelSet,
               const BoundaryValues& boundary, const ContinuationSettings& settings)
      : field_(field),
        solid_(solid),
        levelSet_(levelSet),
        boundary_(boundary),
        settings_(settings),
        voxel_(levelSet.voxelSize()[0]) {}

  std::vector<Vec3fGrid::Ptr> run() {
    const std::size_t count = field_.channels() / 3;
    RegionSettings where;
    where.skin = settings_.skin;
    where.bytesPerVoxel = 1 + 12 * count;
    const openvdb::MaskGrid::Ptr region = activeRegion(levelSet_, where);
    for (std::size_t g = 0; g < count; ++g) grids_.push_back(gridOn(*region));
    evaluate(settings_.spacing > 0 ? *insideOf(*region) : *region);
    const MaskLeaves leaves(region->tree());
    for (std::size_t begin = 0; begin < leaves.leafCount(); begin += kLeavesTogether) {
      reportProgress("meeting the surface",
                     static_cast<double>(begin) / static_cast<double>(leaves.leafCount()));
      meetBoundary(leaves, begin, std::min(begin + kLeavesTogether, leaves.leafCount()));
    }
    return std::move(grids_);
  }

 private:
  Vec3fGrid::Ptr gridOn(const openvdb::MaskGrid& region) const {
    auto grid = Vec3fGrid::create();
    grid->setTree(std::make_shared<openvdb::Vec3STree>(region.tree(), openvdb::Vec3f(0),
                                                       openvdb::TopologyCopy()));
    grid->setTransform(region.transform().copy());
    grid->setVectorType(openvdb::VEC_INVARIANT);
    return grid;
  }

  // Outside, the boundary's own values stand.
  openvdb::MaskGrid::Ptr insideOf(const openvdb::MaskGrid& region) const {
    openvdb::MaskGrid::Ptr inside = region.deepCopy();
    openvdb::tree::LeafManager<openvdb::MaskTree> leaves(inside->tree());
    leaves.foreach ([&](openvdb::MaskTree::LeafNodeType& leaf, std::size_t) {
      const auto distances = levelSet_.getConstAccessor();
      const openvdb::MaskTree::LeafNodeType all(leaf);
      for (auto it = all.cbeginValueOn(); it; ++it)
        if (!(distances.getValue(it.getCoord()) < 0)) leaf.setValueOff(it.pos());
    });
    return inside;
  }

  void evaluate(const openvdb::MaskGrid& region) {
    VisitSettings visit;
    visit.accuracy = settings_.accuracy;
    visit.stage = "continuing inwards";
    visit.gradients = false;
    visitField(
        field_, FieldRegion(solid_, levelSet_, region),
        [&](std::size_t, const LeafValues& v) {
          for (std::size_t g = 0; g < grids_.size(); ++g) {
            Leaf* leaf = grids_[g]->tree().probeLeaf(v.origin);
            for (std::size_t i = 0; i < v.count; ++i) {
              const double* x = v.values + i * v.channels + 3 * g;
              leaf->setValueOnly(v.offset[i], openvdb::Vec3f(openvdb::Vec3d(x[0], x[1], x[2])));
            }
          }
        },
        visit);
  }

  Vec3 worldOf(const openvdb::Vec3d& index) const {
    const openvdb::Vec3d p = levelSet_.indexToWorld(index);
    return {p.x(), p.y(), p.z()};
  }

  std::vector<Near> nearIn(const MaskLeaves& leaves, std::size_t l) const {
    std::vector<Near> out;
    const auto& leaf = leaves.leaf(l);
    const double reach =
        settings_.spacing > 0 ? kReach * settings_.spacing + kExactDepth * voxel_ : 0;
    const Vec3 middle = worldOf(leaf.origin().asVec3d() + openvdb::Vec3d(3.5));
    const double beyond = std::max(reach, (settings_.skin + 1) * voxel_);
    if (solid_.closest(middle, beyond + kLeafRadius * voxel_).onSurface.triangle < 0) return out;
    auto distances = levelSet_.getConstAccessor();
    for (auto it = leaf.cbeginValueOn(); it; ++it) {
      const bool inside = distances.getValue(it.getCoord()) < 0;
      if (inside && !(reach > 0)) continue;
      const Vec3 p = worldOf(it.getCoord().asVec3d());
      const Solid::Closest c =
          solid_.closest(p, inside ? reach : std::numeric_limits<double>::infinity());
      if (c.onSurface.triangle < 0) continue;
      const double depth = c.distance - kExactDepth * voxel_;
      out.push_back({l, it.pos(), inside ? factorAt(depth, settings_.spacing) : 1.0, c, !inside});
    }
    return out;
  }

  // value += factor (boundary - field at the closest point); outside: = boundary.
  void meetBoundary(const MaskLeaves& leaves, std::size_t begin, std::size_t end) {
    std::vector<std::vector<Near>> near(end - begin);
    parallelBlocks(near.size(), 2, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) near[i] = nearIn(leaves, begin + i);
    });
    Points points;
    for (std::vector<Near>& leaf : near)
      for (Near& n : leaf) {
        if (n.outside && settings_.spacing > 0) continue;
        n.row = points.size();
        points.push_back(n.closest.position);
      }
    Matrix fitted;
    if (!points.empty()) fitted = field_.evaluate(points, {settings_.accuracy, false}).values;
    parallelBlocks(near.size(), 8, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i)
        correct(leaves.leaf(begin + i).origin(), near[i], fitted);
    });
  }

  void correct(const openvdb::Coord& origin, const std::vector<Near>& near, const Matrix& fitted) {
    const std::size_t channels = field_.channels();
    std::vector<double> values(channels);
    for (const Near& n : near) {
      if (settings_.spacing > 0) {
        boundary_(n.closest, values.data());
      } else {
        for (std::size_t k = 0; k < channels; ++k) values[k] = fitted(n.row, k);
      }
      for (std::size_t g = 0; g < grids_.size(); ++g) {
        Leaf* leaf = grids_[g]->tree().probeLeaf(origin);
        openvdb::Vec3f v = leaf->getValue(n.offset);
        for (int c = 0; c < 3; ++c) {
          const std::size_t k = 3 * g + static_cast<std::size_t>(c);
          v[c] = static_cast<float>(n.outside ? values[k]
                                              : v[c] + n.factor * (values[k] - fitted(n.row, k)));
        }
        leaf->setValueOnly(n.offset, v);
      }
    }
  }

  const HarmonicField& field_;
  const Solid& solid_;
  const openvdb::FloatGrid& levelSet_;
  const BoundaryValues& boundary_;
  const ContinuationSettings& settings_;
  double voxel_;
  std::vector<Vec3fGrid::Ptr> grids_;
};

}  // namespace

std::vector<Vec3fGrid::Ptr> continueInside(const HarmonicField& field, const Solid& solid,
                                           const openvdb::FloatGrid& levelSet,
                                           const BoundaryValues& boundary,
                                           const ContinuationSettings& settings) {
  if (field.channels() % 3 != 0)
    throw DataError("continuation: the number of channels is not a multiple of three");
  requireNumber("skin", settings.skin, {0, 3}, "voxels");
  requireNumber("spacing", settings.spacing, {0});
  requireNumber("accuracy", settings.accuracy, above(0));
  return Continuation(field, solid, levelSet, boundary, settings).run();
}

}  // namespace innermap
