// Which loops of a closed surface bound inside the solid.
#pragma once

#include "surface/detail/topology/homology.h"

namespace innermap {

// Classes of loops by their coefficients in a HomologyBasis, which is given back by one combination
// of integers only.
struct BoundingClasses {
  IntegerMatrix inside;   // #genus: a basis of the classes that bound inside the solid
  IntegerMatrix outside;  // #genus: and of those that bound outside
};

// By Alexander duality: a class bounds inside when its linking numbers with all loops pushed out of
// the solid vanish. "Outside" is where the triangles' normals point: the shell of a cavity has the
// cavity there. Where the surface is too rough or intersects itself for that to come out
// consistent, a smoothed copy is asked.
// Throws DataError, naming the surface, when no copy gives an answer.
BoundingClasses boundingClasses(const ClosedSurface& surface, const HalfEdges& edges,
                                const HomologyBasis& basis);

// Genus 1: the meridian bounds inside, the longitude outside; the longitude crosses the meridian
// once from right to left, seen from outside.
struct TorusClasses {
  Integers meridian, longitude;
};
TorusClasses torusClasses(const ClosedSurface& surface, const HalfEdges& edges,
                          const HomologyBasis& basis);

}  // namespace innermap
