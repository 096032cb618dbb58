// The solid that a mesh bounds: all points of winding number over one half. For a mesh whose parts
// overlap that is their union, and only the exposed part of the surface bounds it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/mesh/check.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

struct SolidSettings {
  // Triangles that other parts cut are split along the cut until the pieces that it runs through
  // are no longer than this, and each piece is told exposed or buried as a whole; fraction of the
  // diagonal, in (0, 1). Doubled as often as it takes to stay under some millions of pieces.
  double pieceSize = 1.0 / 2048;
};

class SolidBody;

// Immutable; copies share their data; safe from any number of threads.
class Solid {
 public:
  // Repairs the mesh first. Throws DataError when it has no inside, as repair() does.
  explicit Solid(const Mesh& mesh, const SolidSettings& settings = {});

  const RepairedMesh& repaired() const;

  // The exposed surface, oriented outward, as pieces of the repaired mesh's triangles: the whole
  // repaired mesh where nothing overlaps.
  const Mesh& surface() const;

  // The address on repaired().mesh of a point given on surface(), and so on any target.
  SurfacePoint address(const SurfacePoint& onSurface) const;

  bool overlaps() const;  // some of the mesh is buried in other parts
  // Share of the repaired mesh's area that bounds regions of winding number below 0: parts turned
  // inside out, which are no part of the solid.
  double insideOut() const;
  const Box3& box() const;  // of surface()
  double diagonal() const;  // of box(); the unit of all length settings
  double area() const;      // of surface(), world units squared
  // World units cubed, by the divergence theorem over surface(); where that is not closed well
  // enough (pieces larger than 1/64 of the diagonal), by a level set 256 voxels across, once.
  double volume() const;
  // The exact exposed surface is nowhere farther than this from surface(), world units: 0 where
  // nothing overlaps, the size of the pieces along cuts otherwise.
  double gap() const;

  bool inside(const Vec3& p) const;            // winding number over 0.5
  double distance(const Vec3& p) const;        // to surface(), unsigned, exact
  double signedDistance(const Vec3& p) const;  // negative inside

  // Closest point of surface(); triangle -1 when farther than `within`.
  struct Closest {
    SurfacePoint onSurface;
    Vec3 position;
    double distance;
  };
  Closest closest(const Vec3& p, double within) const;

  const SolidBody& body() const;  // for grids of this folder

 private:
  struct Implementation;
  std::shared_ptr<const Implementation> implementation_;
};

}  // namespace innermap
