// Closed shells, and which of them are inside out.
#pragma once

#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

struct ClosedShells {
  Points positions;
  std::vector<Triangle> triangles;
  std::vector<int> shell;  // #T
  int shells = 0;
};

// Signed volume of each shell, world units cubed.
std::vector<double> shellVolumes(const ClosedShells& shells);

// Which shells must be turned: all where the sum of the volumes is negative, and then those of
// negative volume that do not lie inside the others, where they would bound a cavity.
std::vector<bool> invertedShells(const ClosedShells& shells);

}  // namespace innermap
