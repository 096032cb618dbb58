// What the stages of a job are expected to take: a sum over what they work on, by costs that were
// measured once, times how fast this machine is at the moment.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "innermap/levelset/level_set.h"
#include "innermap/levelset/solid.h"
#include "innermap/mesh/mesh.h"
#include "job_clock.h"

namespace innermap::tool {

// What a stage works on.
struct JobSize {
  double inside = 0;   // voxels of the solid, millions
  double surface = 0;  // voxels that its surface runs through, millions
  double charges = 0;  // thousands
  double items = 0;    // whatever else the stage counts
};

JobSize jobSize(double volume, double area, double voxelSize, std::size_t charges);
// Of a solid in voxels; settings: any with a resolution and a voxel size.
template <class Settings>
JobSize jobSize(const Solid& solid, const Settings& settings, std::size_t charges = 0) {
  LevelSetSettings voxels;
  voxels.resolution = settings.resolution;
  voxels.voxelSize = settings.voxelSize;
  return jobSize(solid.volume(), solid.area(), voxelSizeFor(solid, voxels), charges);
}

// With the near sums of charges and voxels as items.
JobSize withNearSums(JobSize size);

// A stage of the library, as it reports it, over `size`; it comes `times` times one after another.
// "STAGE: WHAT": see the table of costs. Throws Error for a stage of which no cost is known.
JobPhase stageOf(const std::string& stage, const JobSize& size, int times = 1,
                 const std::string& title = "");

// About how many places of a surface, in thousands, need charges of their own until the map that
// moves its vertices is met within the tolerance (a fraction of the diagonal): those where it bends
// more than that from one vertex to the next, each as often as it bends so much.
double bentPlaces(const Mesh& source, const Points& moved, double tolerance);
// The same, where it is not known how the vertices move.
double likelyPlaces(std::size_t vertices, double tolerance);

// What a map's grids take once it is fitted, until they are in their file.
std::vector<JobPhase> evaluationPhases(const JobSize& size);
// Laying one surface onto another; vertices of both together.
std::vector<JobPhase> correspondPhases(std::size_t vertices);
// Setting up for the frames of a sequence, and then "frames"; perFrame: beside the fit of each.
std::vector<JobPhase> framePhases(std::size_t charges, std::size_t frames,
                                  const JobPhase& perFrame);

}  // namespace innermap::tool
