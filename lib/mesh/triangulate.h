// One polygon into triangles.
#pragma once

#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

// Cuts the polygon with the given corners (indices into vertices, count >= 3) into count - 2
// triangles of local corner numbers [0, count). A triangle stays as it is; a convex polygon is cut
// as a fan from its lowest vertex index; any other by ear clipping in its mean plane, which starts
// at the lowest index too, so that the cut does not depend on where the file begins the polygon.
// Where that fails (self-crossing or flat polygons, more than 2048 corners) the fan is taken.
void triangulatePolygon(const Points& vertices, const int* corners, int count,
                        std::vector<Triangle>& triangles);

}  // namespace innermap
