// The job of a map, from two meshes as they were given: who is related to whom, and what laying the
// source onto a stranger is done with.
#pragma once

#include <cstdint>
#include <vector>

#include "innermap/correspond/mesh_correspondence.h"
#include "jobs/needs.h"

namespace innermap {

struct MapJob {
  Mesh source, target;
  bool related = true;  // of one connectivity; else the source is to be laid onto the target
  bool laid = false;    // the target is the source as it was laid onto a stranger

  // Whether the boundary comes from a correspondence, which the choice of a tolerance heeds.
  bool laidOn() const { return laid || !related; }
  bool mayTakeSteps(const FitMapSettings& fitting) const {
    return laidOn() && fitting.oneToOne != OneToOne::off;
  }
};

// Finds out whether they are related; a target that is gets the source's polygons.
MapJob mapJob(Mesh source, Mesh target);

// All that the job needs, before anything is laid. solid: of the source. What steps take beside a
// single map is not in it: fitMap() takes none where that is too much.
std::vector<MemoryNeed> mapNeeds(const MapJob& job, const Solid& solid,
                                 const FitMapSettings& fitting, const LatticeChoice& grid);

// For a source that a map with this seed is fitted to afterwards.
MeshCorrespondenceSettings layingSettings(MeshCorrespondenceSettings given, std::uint64_t seed);

}  // namespace innermap
