// Colour grids from grids of texture coordinates.
#pragma once

#include <openvdb/openvdb.h>

#include <vector>

#include "innermap/texture/solid_texture.h"

namespace innermap {

// The colour at each active voxel's coordinates (u, v, anything), averaged over what the voxel
// covers: its neighbours' coordinates tell how much that is, the nearer of the two on each axis, so
// that a jump of the coordinates on one side does not count. Same active voxels and transform,
// background 0, named "Cd". Throws Cancelled. Not a tile may be active.
openvdb::Vec3fGrid::Ptr lookUpColours(const openvdb::Vec3fGrid& uv, const TextureLookup& texture);

// Groups of charts continued each for itself: in grid g the vectors (w, w (u - c.x), w (v - c.y)),
// where w is the continuation of 1 on the group's part of the surface and 0 on the rest, and c a
// centre of the group's coordinates.
struct ChartGroupGrid {
  openvdb::Vec3fGrid::Ptr weighted;
  Vec2 centre;
};

// w less than this, which noise of the fit may be, counts as nothing.
constexpr double kLeastChartWeight = 0.02;

struct BlendedTexture {
  openvdb::Vec3fGrid::Ptr colour;  // sum of w colour(u, v) over sum of w; "Cd"
  openvdb::Vec3fGrid::Ptr uv;      // (u, v, 0) of the group of largest weight; "uv"
};

// All grids with the same active voxels and transform, at least one. Where all weights are nothing,
// the largest counts. Throws DataError, Cancelled.
BlendedTexture blendChartGroups(const std::vector<ChartGroupGrid>& groups,
                                const TextureLookup& texture);

}  // namespace innermap
