// Signed distances around a body's surface: what level sets are made with.
#pragma once

#include <openvdb/openvdb.h>

#include "levelset/detail/solid_body.h"

namespace innermap {

// OpenVDB takes no transform whose determinant is below 3e-15.
constexpr double kLeastVoxel = 1.45e-5;  // world units

// Voxel size that puts `resolution` (positive) voxels along the box's longest side, kLeastVoxel at
// least. Throws DataError for a box that is too small even for 4 of those.
double voxelSizeAcross(const Box3& box, int resolution);

// Centre of voxel (0, 0, 0) unless another is asked for.
Vec3 latticeOrigin(const Box3& box, double voxelSize);

openvdb::math::Transform::Ptr latticeTransform(const Vec3& origin, double voxelSize);

// Level set with exact distances up to `width` (world units). block: if given, only the node of
// that origin, with the values that it has in the whole; all else is outside. Throws Cancelled.
openvdb::FloatGrid::Ptr narrowBand(const SolidBody& body, const Vec3& origin, double voxelSize,
                                   double width, const openvdb::Coord* block = nullptr);

// Volume of the body in world units cubed, from the fog of a level set `resolution` voxels along
// the longest side.
double gridVolume(const SolidBody& body, int resolution);

}  // namespace innermap
