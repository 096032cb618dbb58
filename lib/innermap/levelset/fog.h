// Fog volumes: how much of each voxel lies inside a level set.
#pragma once

#include <openvdb/openvdb.h>

#include "innermap/core/vec3.h"

namespace innermap {

// Fog volume: 1 inside, 0 outside, and the voxel cell's share inside the solid along the surface.
// Named "density", class fog volume. The sum of the values times the voxel's volume is the solid's
// volume.
openvdb::FloatGrid::Ptr makeFog(const openvdb::FloatGrid& levelSet);

// Sum of the values times the voxel's volume, world units cubed.
double fogVolume(const openvdb::FloatGrid& fog);

// The same, as makeFog() of the level set would have it, without the memory for a grid.
double insideVolume(const openvdb::FloatGrid& levelSet);

// Share of the unit cell about a voxel centre on the negative side of the plane with signed
// distance `distance` (voxels) and gradient `normal` (unit vector): Scardovelli and Zaleski,
// "Analytical Relations Connecting Linear Interfaces and Volume Fractions in Rectangular Grids"
// (J. Comp. Phys. 2000).
double cellFraction(double distance, const Vec3& normal);

}  // namespace innermap
