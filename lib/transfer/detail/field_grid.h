// A field of the source on the voxels of the target.
#pragma once

#include "innermap/transfer/carry.h"
#include "innermap/transfer/inverse_map.h"

namespace innermap {

openvdb::GridBase::Ptr fieldGrid(const CarriedField& field, const Solid& source,
                                 const SourceLattice& lattice, const InvertedMap& inverted,
                                 double accuracy);

}  // namespace innermap
