// What is to be evaluated in one leaf of the active region.
#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <cstdint>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/levelset/solid.h"

namespace innermap {

struct LeafPlan {
  // Voxels whose centre is inside: evaluated there. One bit each, as LatticeBlocks has them.
  std::array<std::uint64_t, 8> inside{};
  // Inside voxels whose cell the surface may cut, in ascending order, with the share of the cell
  // that is inside the solid; it is 1 for the others.
  struct Cut {
    std::uint16_t offset = 0;
    double share = 1;
  };
  std::vector<Cut> cut;
  // Active voxels outside: evaluated at the closest boundary point.
  struct Skin {
    std::uint16_t offset = 0;
    double share = 0;
    Vec3 at;      // world units
    Vec3 beyond;  // from there to the voxel's centre
  };
  std::vector<Skin> skin;
};

LeafPlan planLeaf(const openvdb::MaskTree::LeafNodeType& leaf, const openvdb::FloatGrid& levelSet,
                  const Solid& solid);

}  // namespace innermap
