// Shapes between a surface and its image, for maps that go there in steps.
//
// Each triangle's deformation is parted into a rotation and a stretch; the rotation goes by its
// angle (triangle_turns.h), the stretch linearly, and the vertices follow by least squares over the
// edges: Xu, Zhang, Wang and Bao, "Poisson shape interpolation" (SPM 2005), with the triangle
// frames of Sumner and Popovic, "Deformation transfer for triangle meshes" (SIGGRAPH 2004). What
// the whole surface turns, moves and grows is left out of the way, and put back at its end; so is a
// reflection, where one surface is inside out and the other is not.
#pragma once

#include <memory>
#include <vector>

#include "fit/detail/scaled_motion.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

// smoothed: see shape_smoother.h. A longer way, which without handles runs through itself nowhere
// that was looked at, unless an end does.
enum class Between { interpolated, smoothed };

class ShapePath {
 public:
  // from, to: positions of the vertices of `triangles`. growth: the cube root of the volumes'
  // ratio, above 0. Vertices in no triangle go straight.
  ShapePath(const Points& from, const Points& to, const std::vector<Triangle>& triangles,
            double growth, Between between = Between::interpolated);
  ~ShapePath();
  ShapePath(ShapePath&&) noexcept;

  // t in [0, 1]. At 0 `from`; at 1 `to`, turned, moved and scaled to lie as `from` does.
  Points at(double t) const;

  // From at(1) to `to`.
  const ScaledMotion& rest() const;

 private:
  struct Implementation;
  std::unique_ptr<const Implementation> implementation_;
};

}  // namespace innermap
