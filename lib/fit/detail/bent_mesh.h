// The mesh about a carried solid, bent along its edges as their images are: nearer to the exact
// image of the surface than the mesh, and far cheaper to ask than all steps so far.
#pragma once

#include "fit/detail/refined_surface.h"
#include "innermap/levelset/solid.h"

namespace innermap {

class BentMesh {
 public:
  // The solid bounded by the images of a surface, `edges` those of its edges. Holds references.
  BentMesh(const Solid& solid, const EdgeImages& edges) : solid_(solid), edges_(edges) {}

  struct Place {
    Vec3 position;
    double bent;  // how far the triangle's edges are off their chords; infinity: not all known
  };

  // Along an edge the polynomial through both ends and the places that are known; it fades towards
  // the corner across as a quadratic does. Exact for quadratic images.
  Place at(const SurfacePoint& onSurface) const;

 private:
  const Solid& solid_;
  const EdgeImages& edges_;
};

}  // namespace innermap
