// Vertices of the boundary that slid, laid on the surface again.
#pragma once

#include <vector>

#include "tetra/detail/patch_solver.h"

namespace innermap {

// Each of `slid` goes to the surface as far as its tetrahedra stay good; what is inside is
// untangled about those that do not arrive; several times. Those that are off in the end.
std::vector<int> land(const CellSystem& system, const GuideSurface& surface, std::vector<int> slid,
                      double tolerance, const PatchSolverSettings& settings, CarriedCells& cells);

}  // namespace innermap
