// How often a ray goes out of a closed mesh, less how often in: the winding number of its origin.
#pragma once

#include <optional>
#include <vector>

#include "innermap/core/vec3.h"
#include "mesh/detail/local_triangles.h"

namespace innermap {

// Whether each edge is run through as often one way as the other: rays then cross the mesh as often
// as its winding numbers, which are whole, say. A triangle with a repeated vertex has no edges.
bool isBalanced(const std::vector<Triangle>& triangles);

// Out less in, of the ray from p, in the triangles' frame, along the x axis, away from the origin.
// On the surface itself undefined. The ray is moved aside by an infinitely small amount, the same
// for all triangles (Edelsbrunner, Muecke, "Simulation of Simplicity", 1990), and signs are exact,
// so that edges and vertices that it meets count once. Nothing where the signs are undecided: see
// orientation().
std::optional<int> rayCrossings(const LocalTriangles& triangles, const Vec3& p);

}  // namespace innermap
