// A carried mesh with the places that its vertices came from, as a map: linear on each tetrahedron,
// one-to-one where none is inverted.
#pragma once

#include <memory>

#include "innermap/core/vec3.h"
#include "innermap/lattice/cell_mesh.h"
#include "innermap/tetra/cell_locator.h"

namespace innermap {

struct LinearSample {
  Vec3 image;
  Mat3 jacobian{};     // of the way taken
  double outside = 0;  // distance from the mesh, in the units of the point given
};

// Immutable, cheap to copy, safe from any number of threads. Outside the mesh the nearest
// tetrahedron continues linearly.
class LinearCellMap {
 public:
  // carried: what remesh writes, its vertices' field "source" the places that they came from.
  // Throws DataError for a mesh without such a field of three components, with hexahedra, without
  // tetrahedra, or with a tetrahedron that is inverted, there or here (how many).
  explicit LinearCellMap(const CellMesh& carried);

  LinearSample push(const Vec3& p) const;  // from the source
  LinearSample pull(const Vec3& q) const;  // to it

  double sourceDiagonal() const { return sourceDiagonal_; }  // of the box of its vertices
  double targetDiagonal() const { return targetDiagonal_; }

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
  double sourceDiagonal_ = 0, targetDiagonal_ = 0;
};

}  // namespace innermap
