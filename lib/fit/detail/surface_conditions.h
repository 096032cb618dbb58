// Conditions on a mesh, asked for at points of its solid's surface.
#pragma once

#include <array>
#include <memory>

#include "innermap/fit/boundary_pair.h"
#include "innermap/fit/fit_harmonic.h"
#include "innermap/fit/surface_problem.h"
#include "mesh/triangle_tree.h"

namespace innermap {

class SurfaceConditions {
 public:
  // Throws DataError as fitHarmonic does. Keeps references to both.
  SurfaceConditions(const SourceBoundary& boundary, const BoundaryConditions& conditions);

  // Rows as Collocation has them: values, or fluxes times the length of the direction.
  Matrix rows(const std::vector<SurfacePoint>& onSurface) const;
  Points directions(const std::vector<SurfacePoint>& onSurface) const;
  // The values at addresses on repaired().mesh; NaN where a flux is given. Not of a function.
  Matrix valuesAt(const std::vector<SurfacePoint>& addresses) const;

  std::size_t channels() const { return channels_; }
  bool anyFree() const { return fixed_ != nullptr; }
  // Of solid.surface(): whether the flux is given there.
  bool isFree(const SurfacePoint& onSurface) const;
  double freeShare() const { return freeShare_; }  // of its area

 private:
  void check() const;
  void splitSurface();
  void smoothNormals();
  void averageCorners();
  Vec3 normalAt(const SurfacePoint& onSurface) const;
  int inputTriangle(const SurfacePoint& onSurface) const;
  void checkFunction(const Matrix& out, std::size_t points) const;
  Matrix values(const std::vector<SurfacePoint>& onSurface) const;
  Matrix fluxes(const std::vector<SurfacePoint>& onSurface, const Points& normals) const;
  double value(const SurfacePoint& address, std::size_t channel) const;
  // inputTriangle: -1 in a cap.
  double corner(int repairedVertex, int inputTriangle, std::size_t channel) const;

  // Of the diagonal: a direction must not vanish where it is to be one.
  static constexpr double kLeastLength = 1e-9;

  const SourceBoundary& boundary_;
  const BoundaryConditions& conditions_;
  std::size_t channels_ = 0;
  std::vector<std::uint8_t> freePieces_;  // of surface().triangles
  std::unique_ptr<TriangleTree> fixed_;   // where values are given; null: everywhere
  double freeShare_ = 0;
  Matrix ofVertices_;  // where values are given three a triangle: their means at each vertex
  std::vector<std::array<Vec3, 3>>
      normals_;  // at the corners of surface().triangles; if any is free
};

}  // namespace innermap
