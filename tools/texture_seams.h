// Figures on a solid texture: how much of it lies along seams, and how well it meets the surface.
#pragma once

#include <openvdb/openvdb.h>

#include <vector>

#include "context.h"
#include "innermap/levelset/solid.h"
#include "innermap/mesh/uv_charts.h"
#include "innermap/texture/detail/near_segments.h"
#include "texture_surface.h"

namespace innermap::tool {

// Points this near to a seam count as lying along it.
constexpr double kSeamReach = 2;  // voxels

std::vector<Segment> segmentsOf(const Mesh& mesh, const std::vector<UvSeam>& seams);

// The report's "seams": their number and length, the share of the inside's voxels and of the
// surface's area along them, and by how much the texture's own colours differ across them.
void reportSeams(const Solid& solid, const Mesh& mesh, const UvCharts& charts,
                 const TextureSurface& surface, const openvdb::FloatGrid& levelSet,
                 Context& context);

// The report's "surface": the difference between the grid's colours, interpolated at fresh points
// of the surface, and the texture's there; in all, and along the seams.
void reportSurface(const Solid& solid, const std::vector<Segment>& seams,
                   const TextureSurface& surface, const openvdb::Vec3fGrid& colour,
                   std::uint64_t seed, Context& context);

}  // namespace innermap::tool
