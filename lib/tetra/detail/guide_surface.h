// The surface that the boundary of a mesh of cells lies on, and slides along.
#pragma once

#include <array>
#include <vector>

#include "innermap/mesh/mesh.h"
#include "mesh/triangle_tree.h"

namespace innermap {

// Immutable; safe from any number of threads.
class GuideSurface {
 public:
  GuideSurface(const Points& vertices, const std::vector<Triangle>& triangles);

  // Of all triangles.
  ClosestPoint closest(const Vec3& p) const { return tree_.closest(p); }

  // Found by going from triangle to triangle across edges, nearer ones first, from the one given:
  // where two sheets pass close to each other it stays on the one that it is on. No worse than the
  // closest point of that triangle.
  ClosestPoint closestFrom(int triangle, const Vec3& p) const;

  Vec3 position(const SurfacePoint& point) const;
  // Whether the point lies on an edge across which the surface turns by over 40 degrees.
  bool onCrease(const SurfacePoint& point) const;
  // Of length 1; zeros for a triangle without area.
  Vec3 normal(int triangle) const { return normals_[triangle]; }

 private:
  ClosestPoint onTriangle(int triangle, const Vec3& p) const;

  Points vertices_;
  std::vector<Triangle> triangles_;
  std::vector<std::array<int, 3>> across_;  // of each side, from its corner to the next; or -1
  Points normals_;
  TriangleTree tree_;
};

}  // namespace innermap
