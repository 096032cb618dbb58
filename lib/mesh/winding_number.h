// Generalized winding number of a triangle soup, tree-accelerated.
//
// Jacobson, Kavan, Sorkine-Hornung, "Robust Inside-Outside Segmentation using Generalized Winding
// Numbers" (SIGGRAPH 2013); Barill, Dickson, Schmidt, Levin, Jacobson, "Fast Winding Numbers for
// Soups and Clouds" (SIGGRAPH 2018), second-order expansion.
#pragma once

#include <memory>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

class TriangleTree;

// Immutable after construction; safe from any number of threads.
class WindingNumber {
 public:
  WindingNumber() : WindingNumber(Points(), {}) {}  // 0 everywhere
  WindingNumber(const Points& vertices, const std::vector<Triangle>& triangles);
  // `triangles` are those that the tree was made of; this shares the tree's copies of their
  // corners.
  WindingNumber(const TriangleTree& tree, const std::vector<Triangle>& triangles);

  // About 1 inside a closed outward mesh, 0 outside, the number of covers where parts overlap.
  // Absolute error below 1e-2 (accuracy 2 in the paper's terms); on the surface itself undefined.
  double at(const Vec3& p) const;

  // For closed meshes (as repair() makes them), whose winding numbers are whole: the crossings of a
  // ray, exact and much cheaper than at(); of other meshes at() rounded.
  int wholeAt(const Vec3& p) const;

  // The exact sum of solid angles over all triangles, O(#T).
  double exactAt(const Vec3& p) const;

 private:
  struct Implementation;
  std::shared_ptr<const Implementation> implementation_;
};

}  // namespace innermap
