// The job of a map, from two meshes as they were given: who is related to whom, and what laying the
// source onto a stranger is done with.
#pragma once

#include <cstdint>

#include "innermap/correspond/mesh_correspondence.h"

namespace innermap {

struct MapJob {
  Mesh source, target;
  bool related = true;  // of one connectivity; else the source is to be laid onto the target
  bool laid = false;    // the target is the source as it was laid onto a stranger

  // Whether the boundary comes from a correspondence, which the choice of a tolerance heeds.
  bool laidOn() const { return laid || !related; }
};

// Finds out whether they are related; a target that is gets the source's polygons.
MapJob mapJob(Mesh source, Mesh target);

// For a source that a map with this seed is fitted to afterwards.
MeshCorrespondenceSettings layingSettings(MeshCorrespondenceSettings given, std::uint64_t seed);

}  // namespace innermap
