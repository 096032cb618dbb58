// invertMap() block by block, on whichever machine.
#pragma once

#include "innermap/transfer/inverse_map.h"
#include "transfer/detail/cell_images.h"

namespace innermap {

// What all blocks of a target need: the lattice's images on its lattice.
LatticeImages imagesOf(const ComposedMap& map, const Solid& source, const SourceLattice& lattice,
                       const openvdb::math::Transform& target, const InverseSettings& settings);

// targetLevelSet: of one block, as makeLevelSetBlock() has it. The sources and Jacobians that
// invertMap() gives the block's voxels, to the bit; without outside settings. Throws as that, but
// for a block of which nothing is inverted.
InvertedMap invertBlock(const ComposedMap& map, const Solid& source, const SourceLattice& lattice,
                        const LatticeImages& images, const openvdb::FloatGrid& targetLevelSet,
                        const InverseSettings& settings);

// Throws DataError where nothing of the target is inverted.
void requireInverted(const InverseStatistics& statistics);

}  // namespace innermap
