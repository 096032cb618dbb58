// Figures on a solid texture: how much of it lies along seams, and how well it meets the surface.
#pragma once

#include <openvdb/openvdb.h>

#include <vector>

#include "innermap/field/fit.h"
#include "innermap/levelset/solid.h"
#include "mesh/uv_charts.h"
#include "texture/detail/near_segments.h"
#include "texture/detail/surface_texture.h"

namespace innermap {

// Points this near to a seam count as lying along it.
constexpr double kSeamReach = 2;  // voxels

std::vector<Segment> segmentsOf(const Mesh& mesh, const std::vector<UvSeam>& seams);

// Voxels inside along the segments.
std::uint64_t voxelsAlong(const std::vector<Segment>& segments, const openvdb::FloatGrid& levelSet);

// Share of the surface's area along the segments, by random points.
double areaShareAlong(const std::vector<Segment>& segments, const Solid& solid, double voxel);

// Of the texture's own colours between the two sides of seams, about each voxel along them.
BoundaryError seamDifferences(const Mesh& mesh, const UvCharts& charts,
                              const SurfaceTexture& surface, double voxel);

struct ColourErrors {
  BoundaryError all, atSeams;
};

// Of the grid's colours, interpolated at random points of the surface, to the texture's there.
ColourErrors colourErrors(const Solid& solid, const std::vector<Segment>& seams,
                          const SurfaceTexture& surface, const openvdb::Vec3fGrid& colour,
                          std::uint64_t seed);

}  // namespace innermap
