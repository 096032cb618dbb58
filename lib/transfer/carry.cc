#include "innermap/transfer/carry.h"

#include <algorithm>
#include <cmath>

namespace innermap {

void ResamplingFigures::add(double growth) {
  const double size = std::abs(growth);
  if (!(size > 0)) return;
  const double volume = 1 / size;  // of the input that comes to a voxel of the output
  sum += volume;
  largestGrowth = std::max(largestGrowth, volume);
  if (outputVoxel > kCoarser * inputVoxel * std::cbrt(size)) coarser += volume;
}

void ResamplingFigures::add(const ResamplingFigures& others) {
  sum += others.sum;
  coarser += others.coarser;
  largestGrowth = std::max(largestGrowth, others.largestGrowth);
}

void ResamplingFigures::finish() { coarserShare = sum > 0 ? coarser / sum : 0; }

double finestVoxel(const openvdb::GridPtrVec& grids) {
  double finest = 0;
  for (const openvdb::GridBase::Ptr& grid : grids) {
    const openvdb::Vec3d size = grid->voxelSize();
    const double smallest = std::min({size.x(), size.y(), size.z()});
    if (finest == 0 || smallest < finest) finest = smallest;
  }
  return finest;
}

double volumeRatio(double from, double to) { return from > 0 && to > 0 ? to / from : 1; }

double voxelGrowth(double from, double to) {
  constexpr double kAlike = 0.1;
  const double growth = std::cbrt(volumeRatio(from, to));
  return std::abs(growth - 1) <= kAlike ? 1 : growth;
}

std::vector<Setting> describe(CarrySettings& s) {
  return {Setting("sampling", "WAY",
                  choiceOf<Sampling>(&s.sampling, {{"nearest", Sampling::nearest},
                                                   {"linear", Sampling::linear},
                                                   {"quadratic", Sampling::quadratic}}),
                  "how to sample between voxels; whole numbers always come from the nearest"),
          Setting("density_limit", "TIMES", &s.densityLimit,
                  "most times that a density may grow; innermap leaves out the mass beyond it and "
                  "reports how much")
              .above(0, 1e300)
              .otherwise(std::numeric_limits<double>::infinity(), "none")};
}

}  // namespace innermap
