// The distance field of a target solid, seen through a map onto its source: Li, Guo, Wang, He, Gu
// and Qin, "Meshless Harmonic Volumetric Mapping Using Fundamental Solution Methods" (IEEE
// Transactions on Automation Science and Engineering, 2009), section on transferring fields.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>

#include "innermap/core/run.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/levelset/solid.h"

namespace innermap {

// How deep below a solid's surface points are: the distance to the closest point of the surface,
// world units, positive inside and negative outside. Exact at every voxel (double precision,
// rounded to float), not only in a band, for any solid: inside is told by the winding number.

struct DepthSettings {
  double skin = 2;  // active voxels outside the surface, in [0, 3]
};

// levelSet: of `solid`, half-width at least the skin; its transform is that of the result, which is
// active where the signed distance is at most the skin, named "distance", background 0. Throws
// SettingError, MemoryError (before allocating), Cancelled. Same result for any number of threads.
openvdb::FloatGrid::Ptr depthInside(const Solid& solid, const openvdb::FloatGrid& levelSet,
                                    const DepthSettings& settings = {});

// map: at each active voxel a position in the target's space, world units, as MapGrids::map has
// them. The result has the map's transform and active voxels: how deep its value lies in `target`.
// No interpolation. Named "distance", background 0. Throws Cancelled.
openvdb::FloatGrid::Ptr depthThrough(const openvdb::Vec3fGrid& map, const Solid& target);

// Of voxels whose centre is inside the solid.
struct DepthFigures {
  std::uint64_t voxels = 0, negative = 0;
  double largest = 0;  // world units
};

// distance: on active voxels of `levelSet`.
DepthFigures depthFigures(const openvdb::FloatGrid& distance, const openvdb::FloatGrid& levelSet);

struct DistanceTransferSettings {
  // Of each of the two solids' grids: as in LevelSetSettings.
  double voxelSize = 0;    // world units; 0 means: resolution decides
  int resolution = 0;      // voxels along the longest side
  double accuracy = 1e-7;  // of the map's sums: as in EvaluateSettings
};

// A solid's level set "surface", how deep its voxels lie in it, and the figures of that.
struct SolidDepths {
  openvdb::FloatGrid::Ptr surface, depth;
  DepthFigures figures;
};

struct DistanceTransfer {
  SolidDepths source, target;       // depths: "source_distance" and "distance"
  openvdb::FloatGrid::Ptr through;  // on the source's voxels, "distance": of their images
  DepthFigures throughFigures;
  double outsideFraction = 0;  // of the source's voxels: mapped outside the target
  StageSeconds seconds;        // voxelize, distance, evaluate, transfer
};

// Where `map` takes the voxels of `source`, how deep is it in `target`, beside both solids' own
// depths. Throws DataError for a source thinner than the voxels everywhere, SettingError,
// MemoryError, Cancelled.
DistanceTransfer transferDistance(const ComposedMap& map, const Solid& source, const Solid& target,
                                  const DistanceTransferSettings& settings = {});

// Need of that in bytes, from the solids' volumes and areas. Throws Cancelled.
std::uint64_t distanceTransferMemory(const Solid& source, const Solid& target,
                                     const DistanceTransferSettings& settings = {});

}  // namespace innermap
