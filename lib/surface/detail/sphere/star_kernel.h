// Where a vertex may stand so that all triangles around it are positive.
#pragma once

#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/surface/correspond.h"
#include "surface/detail/refining/progressive_mesh.h"

namespace innermap {

// The places of the ring of a vertex, in order, in the frame of the vertex's own copy.
using RingPlaces = std::vector<Vec3>;

void ringPlaces(const Layout& layout, const Ring& ring, RingPlaces& out);

// Two directions that span the tangent plane at a point of the space.
struct Tangent {
  Vec3 u, v;
};
Tangent tangentAt(ModelSpace space, const Vec3& p);

// A point moved along a tangent vector: normalised on the sphere.
inline Vec3 moveAlong(ModelSpace space, const Vec3& p, const Vec3& d) {
  const Vec3 q = p + d;
  return space == ModelSpace::sphere ? q / norm(q) : q;
}

// Whether all triangles of the star have tripleProduct above 0.
bool starIsValid(const Vec3& p, const RingPlaces& ring);

// A valid place next to ring[w], where a fan of ring[w] over the ring is valid. False when rounding
// leaves none.
bool placeNear(ModelSpace space, const RingPlaces& ring, std::size_t w, Vec3& place);

// Centroid, in the tangent plane at p, of the kernel of the ring: all places that see the whole
// ring. p must be valid; returns p where rounding leaves no better.
Vec3 kernelCentroid(ModelSpace space, const Vec3& p, const RingPlaces& ring);

}  // namespace innermap
