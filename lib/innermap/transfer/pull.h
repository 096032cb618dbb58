// Pull back: grids that live in the target, brought to the source by the solid's map.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <string>
#include <vector>

#include "innermap/field/harmonic_map.h"
#include "innermap/levelset/solid.h"
#include "innermap/transfer/carry.h"
#include "innermap/transfer/outside.h"
#include "innermap/transfer/through_map.h"

namespace innermap {

struct PullSettings {
  CarrySettings carry;
  OutsideSettings outside;
  double skin = 2;         // active voxels outside the surface, in [0, 3]
  double accuracy = 1e-7;  // of the sums of charges, as EvaluateSettings::accuracy
  // Of the target's solid, half-width at least 3 voxels; null when it is not known. With it,
  // attributes that end at the target's surface are continued by three voxels beyond, so that what
  // is sampled along the surface does not mix with the background; positions need it.
  const openvdb::FloatGrid* targetLevelSet = nullptr;
  // Goes this way instead of by the map. Null: by the map.
  const ThroughMap* through = nullptr;
};

struct PullResult {
  openvdb::GridPtrVec grids;     // in the order given
  std::uint64_t voxels = 0;      // active
  ResamplingFigures resampling;  // of the voxels inside; none when pulled through a mesh
  std::vector<std::string> warnings;
};

// For each voxel p of the source, the grids' values at f(p), moved back by what they are. levelSet:
// of `source`, half-width at least the skin; its transform is that of the output, which is active
// where the signed distance is at most the skin (with outside settings: the outside distance).
// Names, classes, backgrounds, vector types and metadata stay; level sets are rebuilt as distances,
// and where one is the target's own surface, to a voxel, it becomes the source's.
// Throws as VolumePusher does.
PullResult pullGrids(const ComposedMap& map, const Solid& source,
                     const openvdb::FloatGrid& levelSet, const openvdb::GridPtrVec& grids,
                     const PullSettings& settings = {});

}  // namespace innermap
