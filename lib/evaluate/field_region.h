// Voxels of a solid's lattice, inside and in a skin about it, and where fields are evaluated for
// them.
#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>
#include <vector>

#include "innermap/levelset/solid.h"

namespace innermap {

struct LeafPlan;

// Holds references. Safe from any number of threads.
class FieldRegion {
 public:
  // levelSet: of `solid`. mask: on the same lattice, without tiles; voxels outside the solid may be
  // at any distance from it. Throws DataError when the lattices differ or the mask has tiles.
  FieldRegion(const Solid& solid, const openvdb::FloatGrid& levelSet,
              const openvdb::MaskGrid& mask);
  FieldRegion(FieldRegion&&) noexcept;
  ~FieldRegion();

  // Looks for the places of all leaves now, and keeps them: for a region that several fields are
  // evaluated in. Some 70 bytes a voxel of the skin. Throws Cancelled.
  void keepPlans();

  const Solid& solid() const { return solid_; }
  const openvdb::FloatGrid& levelSet() const { return levelSet_; }
  const openvdb::MaskGrid& mask() const { return mask_; }

  std::size_t leafCount() const { return leaves_.size(); }
  openvdb::Coord origin(std::size_t leaf) const { return leaves_[leaf]->origin(); }

  // Of the leaves from `begin` on, in their tree's order. made: holds them where none are kept.
  const LeafPlan* plans(std::size_t begin, std::size_t end, std::vector<LeafPlan>& made) const;

 private:
  const Solid& solid_;
  const openvdb::FloatGrid& levelSet_;
  const openvdb::MaskGrid& mask_;
  std::vector<const openvdb::MaskTree::LeafNodeType*> leaves_;
  std::vector<LeafPlan> kept_;  // of all leaves, or none
};

}  // namespace innermap
