// From points of a solid's surface back to the triangles of the mesh as it was read, whose corners
// carry texture coordinates and colours.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "innermap/levelset/solid.h"
#include "innermap/mesh/mesh.h"
#include "mesh/triangle_tree.h"

namespace innermap {

// A point of a triangle of the input mesh, its corners in the input's order.
struct InputPoint {
  int triangle = 0;
  std::array<double, 3> weights{1, 0, 0};  // sum to 1

  // The mean of a value at each corner.
  template <class At>
  auto mean(const At& atCorner) const {
    return weights[0] * atCorner(0) + weights[1] * atCorner(1) + weights[2] * atCorner(2);
  }
};

// Immutable; safe from any number of threads. Keeps copies of what it is given.
class InputLookup {
 public:
  // mesh: what `solid` was made of. bears: #T of the mesh, 1 where a triangle has the attribute
  // that is wanted. Throws DataError when the sizes disagree, and when no triangle on the exposed
  // surface has the attribute (`attribute` names it).
  InputLookup(const Solid& solid, const Mesh& mesh, const std::vector<char>& bears,
              const char* attribute);

  // Of a point of solid.surface(). Where the triangle there lacks the attribute, or is a cap: the
  // nearest point that has it.
  InputPoint at(const SurfacePoint& onSurface) const;

  double bearingShare() const { return bearingShare_; }  // of the surface's area

 private:
  std::optional<InputPoint> own(const SurfacePoint& onSurface) const;

  Solid solid_;
  std::vector<Triangle> triangles_;  // of the input
  std::vector<char> bears_;
  std::optional<TriangleTree> tree_;  // of the surface's bearing triangles, when not all are
  std::vector<int> bearing_;
  double bearingShare_ = 1;
};

}  // namespace innermap
