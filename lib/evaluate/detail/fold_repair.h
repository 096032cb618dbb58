// A map's folds on the voxels of its solid, taken out: about each the map is replaced by one that
// is linear on the tetrahedra between voxels and turns none of them inside out.
#pragma once

#include <openvdb/openvdb.h>

#include <unordered_map>

#include "innermap/core/vec3.h"

namespace innermap {

struct RepairedVoxel {
  Vec3 position;  // world units of the target
  Mat3 jacobian;  // mean of the tetrahedra about the voxel; of the map's sign
};

struct CoordHash {
  std::size_t operator()(const openvdb::Coord& c) const { return c.hash<20>(); }
};

struct FoldRepair {
  std::unordered_map<openvdb::Coord, RepairedVoxel, CoordHash> voxels;  // that were moved
  double farthest = 0;  // way of one of them, world units of the target
};

constexpr const char* kRepairing = "repairing folds";  // the stage

struct FoldRepairSettings {
  double growth = 1;      // cube root of the volumes' ratio, target to source
  bool mirrored = false;  // det J < 0 where nothing is folded
};

// map, jacobian: of evaluateMap, with the level set of the solid. Folded voxels inside, and corners
// of cells between voxels that are inside out (kuhn_cells.h), that are near each other are repaired
// together with the voxels 2 about them, those farther away staying where they are; where that does
// not do, 4 and then 8. Over 6,000 that would move together are left, but for folded voxels alone.
// One in a part too thin for tetrahedra follows those about it. The skin outside stays as it is.
// Throws Cancelled. The same for any number of threads.
FoldRepair repairFolds(const openvdb::Vec3fGrid& map, const openvdb::FloatGrid& jacobian,
                       const openvdb::FloatGrid& levelSet, const FoldRepairSettings& settings);

}  // namespace innermap
