// How far triangles are from what their vertices may be samples of.
#pragma once

#include <functional>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

// Derivatives of the map along the normals, at points: #points.
using NormalDerivatives = std::function<std::vector<Vec3>(const Points& at, const Points& normals)>;

struct TriangleErrorSettings {
  std::size_t triangles = 4000;  // that are looked at: those where vertices around miss the most
};

// A map that is known at the vertices, linear on the triangles, against one that is smooth: about
// the largest distance between the two on any triangle, in the units of `values`; 0 where all is
// affine.
//
// Vertices around a triangle, which took no part in it, are held against the plane that it puts
// through the values: what they miss it by grows with the square of the distance where the map is
// smooth, so on the triangle itself, three times finer, the quadratic polynomial through its
// corners that comes nearest to them says what the triangle misses. What that leaves of their
// misses is added. Across a bent surface the derivative along the normal, which the vertices do not
// tell, takes the plane to them.
double triangleError(const Mesh& mesh, const Points& values, const NormalDerivatives& derivatives,
                     const TriangleErrorSettings& settings = {});

}  // namespace innermap
