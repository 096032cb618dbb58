// The part of a surface that is near to given marks.
#pragma once

#include <array>
#include <vector>

#include "core/point_grid.h"
#include "innermap/levelset/solid.h"

namespace innermap {

// For random samples by area. Triangles that are partly out of reach are cut: where they are large,
// most samples of them would be in vain.
class SurfacePatch {
 public:
  // Without marks: all of the surface. Lengths in the surface's units; parts that are only partly
  // within reach are at most `fine` wide.
  SurfacePatch(const Mesh& surface, const Points& marks, double reach, double fine);

  // Little more than what is within reach, and no less.
  double area() const { return cumulative_.empty() ? 0 : cumulative_.back(); }

  // At a share of the area, in [0, 1), in the order of the triangles, and uniform in its triangle
  // for u, v uniform in [0, 1).
  SurfacePoint sample(double share, double u, double v) const;

  bool holds(const Vec3& p) const { return all_ || anyMarkNearer(p, reach_); }

 private:
  using Barycentric = std::array<double, 3>;
  using Corners = std::array<Barycentric, 3>;
  struct Part {
    int triangle;
    Corners corners;
    double area;  // twice
  };

  bool anyMarkNearer(const Vec3& p, double radius) const;
  static Barycentric at(const Corners& corners, const Barycentric& inside);
  // half: of the diagonal of the part's box; handed down, as rounding may keep a box from
  // shrinking.
  void addNear(int triangle, const Corners& corners, double half, std::vector<Part>& parts) const;

  const Mesh& surface_;
  // The marks, in cells each kCoarser times as wide as those before: large triangles are far from
  // most marks, and would be looked for in thousands of small cells.
  std::vector<PointGrid> marks_;
  const double reach_, fine_;
  const bool all_;
  std::vector<Part> parts_;
  std::vector<double> cumulative_;  // areas, twice
};

}  // namespace innermap
