// What a Solid asks about its surface: all of it but its volume, which may take a level set.
#pragma once

#include "innermap/core/vec3.h"
#include "innermap/mesh/check.h"
#include "innermap/mesh/mesh.h"
#include "levelset/detail/exposed_surface.h"
#include "mesh/triangle_tree.h"

namespace innermap {

class SolidBody {
 public:
  SolidBody(RepairedMesh mesh, ExposedSurface surface);

  const RepairedMesh& repaired() const { return repaired_; }
  const ExposedSurface& exposed() const { return exposed_; }
  const Mesh& surface() const { return exposed_.whole ? repaired_.mesh : exposed_.mesh; }
  const Box3& box() const { return box_; }  // of surface()
  double area() const { return area_; }     // of surface()
  double gap() const { return exposed_.gap; }

  bool inside(const Vec3& p) const { return exposed_.winding.wholeAt(p - exposed_.center) > 0; }
  // Triangle -1 when farther than `within`.
  ClosestPoint closest(const Vec3& p, double within) const { return tree_.closest(p, within); }

  const TriangleTree& tree() const { return tree_; }

  // By the divergence theorem; whether that is exact enough.
  double enclosedVolume() const { return signedVolume(surface()); }
  bool closedWellEnough() const;

 private:
  RepairedMesh repaired_;
  ExposedSurface exposed_;
  Box3 box_;
  double area_ = 0;
  TriangleTree tree_;
};

}  // namespace innermap
