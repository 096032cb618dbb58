// Places in a solid as colours, by which pictures of maps say where each point comes from.
#pragma once

#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/io/solid_pictures.h"

namespace innermap {

// Red, green and blue along the axes of the box, with a chequered pattern in which stretch can be
// seen. Linear, #points.
std::vector<Vec3> placeColours(const Points& points, const Box3& box);

std::vector<SurfacePoint> addresses(const std::vector<VisiblePoint>& seen);

}  // namespace innermap
