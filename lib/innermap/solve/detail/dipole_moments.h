// Moments of triangles that are layers of dipoles along their normals.
#pragma once

#include <array>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/solve/detail/ball_tree.h"
#include "innermap/solve/detail/solid_harmonics.h"

namespace innermap {

using Corners = std::array<Vec3, 3>;

class DipoleMoments {
 public:
  explicit DipoleMoments(const SolidHarmonics& harmonics);

  // Adds the moments of charges with the same far potential as the solid angles of the triangles:
  // minus the integral of n . grad N_nm. Exact: a Gauss rule for the polynomials' degree.
  void add(const Corners* triangles, std::size_t count, const Ball& ball, double* moments) const;

 private:
  const SolidHarmonics& harmonics_;
  std::vector<std::array<double, 3>> rule_;  // two barycentric coordinates and the weight
};

}  // namespace innermap
