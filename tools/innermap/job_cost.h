// What the stages of a job are expected to take: a weight for each times the size of what it works
// on, times how fast this machine is at the moment.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "innermap/levelset/level_set.h"
#include "innermap/levelset/solid.h"
#include "innermap/mesh/mesh.h"
#include "job_clock.h"
#include "report/report_figures.h"

namespace innermap::tool {

JobSize jobSize(double volume, double area, double voxelSize, std::size_t charges);
// Of a solid in voxels; settings: any with a resolution and a voxel size.
template <class Settings>
JobSize jobSize(const Solid& solid, const Settings& settings, std::size_t charges = 0) {
  LevelSetSettings voxels;
  voxels.resolution = settings.resolution;
  voxels.voxelSize = settings.voxelSize;
  return jobSize(solid.volume(), solid.area(), voxelSizeFor(solid, voxels), charges);
}

// A stage of the library, as it reports it, over `size`; it comes `times` times one after another.
// "STAGE: WHAT" is a row for a stage that takes another time when it does that. Throws Error for a
// stage that has no row.
JobPhase stageOf(const std::string& stage, const JobSize& size, int times = 1,
                 const std::string& title = "");

// About how many places of a surface, in thousands, need charges of their own until the map that
// moves its vertices is met within the tolerance (a fraction of the diagonal): those where it bends
// more than that from one vertex to the next, each as often as it bends so much.
double bentPlaces(const Mesh& source, const Points& moved, double tolerance);
// The same, where it is not known how the vertices move.
double likelyPlaces(std::size_t vertices, double tolerance);

// With how fast this machine is, by a block of work on it.
StageFigures stageFigures(const std::vector<JobPhaseTaken>& taken);

// What a map's grids take once it is fitted, until they are in their file.
std::vector<JobPhase> evaluationPhases(const JobSize& size);
// Laying one surface onto another; vertices of both together.
std::vector<JobPhase> correspondPhases(std::size_t vertices);
// Setting up for the frames of a sequence, and then "frames"; perFrame: beside the fit of each.
std::vector<JobPhase> framePhases(std::size_t charges, std::size_t frames,
                                  const JobPhase& perFrame);

}  // namespace innermap::tool
