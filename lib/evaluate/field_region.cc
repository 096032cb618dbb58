#include "evaluate/field_region.h"

#include "evaluate/detail/leaf_plan.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

void requireSameLattice(const openvdb::FloatGrid& levelSet, const openvdb::MaskGrid& region) {
  // To a thousandth of a voxel: equality of transforms is by absolute tolerances, which rounding of
  // what is far from the origin exceeds.
  constexpr double kOff = 1e-3, kFar = 1000;  // voxels
  const auto &a = levelSet.transform(), &b = region.transform();
  const auto off = [&](double index) {
    const openvdb::Vec3d at(index);
    return (a.indexToWorld(at) - b.indexToWorld(at)).length() / a.voxelSize()[0];
  };
  if (!a.isLinear() || !b.isLinear() || !(off(0) <= kOff) || !(off(kFar) <= kOff))
    throw DataError("region: is on another lattice than the level set");
  if (region.tree().hasActiveTiles()) throw DataError("region: has active tiles, not voxels only");
}

}  // namespace

FieldRegion::FieldRegion(const Solid& solid, const openvdb::FloatGrid& levelSet,
                         const openvdb::MaskGrid& mask)
    : solid_(solid), levelSet_(levelSet), mask_(mask) {
  requireSameLattice(levelSet, mask);
  mask.tree().getNodes(leaves_);
}

FieldRegion::FieldRegion(FieldRegion&&) noexcept = default;
FieldRegion::~FieldRegion() = default;

void FieldRegion::keepPlans() {
  std::vector<LeafPlan> made;
  plans(0, leafCount(), made);
  kept_ = std::move(made);
}

const LeafPlan* FieldRegion::plans(std::size_t begin, std::size_t end,
                                   std::vector<LeafPlan>& made) const {
  if (!kept_.empty()) return kept_.data() + begin;
  made.resize(end - begin);
  parallelBlocks(made.size(), 4, [&](std::size_t first, std::size_t last) {
    for (std::size_t l = first; l < last; ++l)
      made[l] = planLeaf(*leaves_[begin + l], levelSet_, solid_);
  });
  return made.data();
}

}  // namespace innermap
