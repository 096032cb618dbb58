// Which voxels of a grid are active, whatever its values: what follows from that alone is compiled
// once, for masks, and not for each type of values.
#pragma once

#include <openvdb/openvdb.h>

namespace innermap {

// The types of grids that innermap reads, carries and writes.
using GridTypes = openvdb::TypeList<openvdb::FloatGrid, openvdb::DoubleGrid, openvdb::Int32Grid,
                                    openvdb::Int64Grid, openvdb::BoolGrid, openvdb::MaskGrid,
                                    openvdb::Vec3SGrid, openvdb::Vec3DGrid, openvdb::Vec3IGrid>;

// The active voxels and tiles of a grid of GridTypes; nothing for others.
openvdb::MaskTree activeTopology(const openvdb::GridBase& grid);

// A grid of the type, background and metadata of `like`, one of GridTypes: where `region` is
// active, with the background as value, on the region's transform. Null for other types.
openvdb::GridBase::Ptr emptyLike(const openvdb::GridBase& like, const openvdb::MaskGrid& region);

// A grid with the background 0 where `region` is active, on its transform.
openvdb::FloatGrid::Ptr floatGridOn(const openvdb::MaskGrid& region);
openvdb::Vec3SGrid::Ptr vectorGridOn(const openvdb::MaskGrid& region);

}  // namespace innermap
