// Which voxels of a density are carried, and how it runs within each of them.
#pragma once

#include <openvdb/openvdb.h>

#include <memory>

#include "innermap/levelset/solid.h"
#include "innermap/transfer/carry.h"

namespace innermap {

struct DensityVoxels {
  openvdb::GridBase::ConstPtr grid;  // float or double, any linear transform
  std::shared_ptr<const openvdb::MaskTree> carried;
  double mass = 0;  // of those, sum of values times the voxel's volume in world units
  double left = 0;  // of all other active voxels
};

// Active voxels that may be carried: those near the solid's box or, where `outside` has no end,
// all. May have tiles.
openvdb::MaskTree activeNear(const openvdb::GridBase& grid, const Solid& solid,
                             const OutsideSettings& outside);

// Carried are those of its active voxels whose centre is inside the solid; of a fog volume, whose
// values along the surface are shares, those that touch the solid; with `outside` also those up to
// its distance, or all. levelSet: of the solid. Throws DataError for a transform that is not
// linear, MemoryError, Cancelled.
DensityVoxels densityVoxels(const openvdb::GridBase::ConstPtr& grid, const Solid& solid,
                            const openvdb::FloatGrid& levelSet, const OutsideSettings& outside);

// In one voxel, as a function of the index minus the voxel's.
struct LinearDensity {
  double mean = 0;
  Vec3 slope;
};

// For one thread: it keeps an accessor.
class DensityReader {
 public:
  virtual ~DensityReader() = default;
  // Central differences, limited so that no corner of the voxel is above or below all 27 voxels
  // about it: Barth and Jespersen, "The design and application of upwind schemes on unstructured
  // meshes" (AIAA paper 89-0366, 1989).
  virtual LinearDensity at(const openvdb::Coord& voxel) const = 0;
};

// grid: float or double. constant: no slopes.
std::unique_ptr<DensityReader> readerOf(const openvdb::GridBase& grid, bool constant);

// Sum of the active values times the voxel's volume in world units.
double massOf(const openvdb::GridBase& grid);

}  // namespace innermap
