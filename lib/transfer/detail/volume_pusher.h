// What VolumePusher keeps, and what pushing in one run and in blocks have in common.
#pragma once

#include <utility>
#include <vector>

#include "innermap/transfer/push_pull.h"
#include "transfer/detail/block_figures.h"
#include "transfer/detail/carry_density.h"
#include "transfer/detail/carry_output.h"
#include "transfer/detail/density_voxels.h"
#include "transfer/detail/extended_map.h"
#include "transfer/detail/source_lattice.h"

namespace innermap {

struct VolumePusher::Data {
  Solid source;
  openvdb::GridPtrVec grids;
  PushSettings settings;
  SourceLattice lattice;
  Carriers sampled;
  std::vector<std::pair<std::size_t, DensityVoxels>> densities;  // by place among the grids
  std::vector<std::string> warnings;

  openvdb::MaskGrid::Ptr regionOf(const openvdb::FloatGrid& target) const;
  PushResult result(const CarryFigures& figures) const;
  PushResult uninverted(std::uint64_t voxels) const;
  ExtendedMap extended(const SolidMap& map) const;
  Vec3 inSolid(const Vec3& p) const;
  void carrySampled(const InvertedMap& inverted, const CarryOutput& output) const;
  void finish(const SolidMap& map, CarryOutput& output, openvdb::GridPtrVec& out) const;
  void carryDensities(const SolidMap& map, const openvdb::MaskGrid& region, PushResult& out) const;
};

InverseSettings inverseSettings(const PushSettings& settings);

// By how much the map makes lengths grow in the mean: by the volume within the boundary's images.
double meanGrowth(const SolidMap& map, const Solid& source, double accuracy);

// grown: meanGrowth(); to: the target's voxels. Cells are so fine that their images are about as
// fine as those.
CarryDensitySettings densitySettings(const openvdb::GridBase& density, double grown, double to,
                                     const CarrySettings& carry);

// Of each block, in their order.
std::vector<BlockFigures> resamplingOf(const InvertedMap& inverted,
                                       const openvdb::FloatGrid& target,
                                       const openvdb::GridPtrVec& grids);

}  // namespace innermap
