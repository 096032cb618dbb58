// One patch of cells untangled in place.
#pragma once

#include <vector>

#include "tetra/detail/cell_system.h"
#include "tetra/detail/guide_surface.h"

namespace innermap {

struct PatchSolverSettings {
  double least = 1e-4;  // quality that counts as good
  double volumeShare = 0.5;
  int rounds = 20;
  double stiffness = 20;  // of the springs along normals, times cells a vertex by edge squared
  double growth = 1.5;    // of that, a round
  double most = 30;       // times the first stiffness
  // Vertices of the boundary that this is true of stay on their places by anchors besides.
  double anchor = 0;
  const Points* anchors = nullptr;  // #V
};

struct PatchResult {
  std::size_t poorBefore = 0, poorAfter = 0;
};

// Keeps what it finds where fewer tetrahedra are poor than before, or with `always` where no more
// are. Moves the patch's vertices alone.
PatchResult solvePatch(const CellSystem& system, const GuideSurface& surface,
                       const CellPatch& patch, const PatchSolverSettings& settings, bool always,
                       CarriedCells& cells);

// One patch after the other, side by side; tetrahedra of all of them that are poor afterwards.
std::size_t solvePatches(const CellSystem& system, const GuideSurface& surface,
                         const std::vector<CellPatch>& patches, const PatchSolverSettings& settings,
                         bool always, CarriedCells& cells);

}  // namespace innermap
