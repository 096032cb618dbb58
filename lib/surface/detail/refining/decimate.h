// Which vertices a progressive mesh gives up first.
#pragma once

#include "surface/detail/refining/progressive_mesh.h"

namespace innermap {

struct DecimateSettings {
  std::size_t vertices = 4;        // to keep; more stay where no collapse is possible
  std::vector<char> keep;          // #V or empty: vertices that must stay
  const Layout* layout = nullptr;  // when given, its triangles stay positive in it
};

// Half-edge collapses by quadric error (Garland and Heckbert, "Surface simplification using quadric
// error metrics", 1997) over the worst new triangle's quality; the coarse mesh has the form of the
// fine one, and triangles and valences that later refinement can work with.
void decimate(ProgressiveMesh& mesh, const Points& vertices, const DecimateSettings& settings);

}  // namespace innermap
