// One part of a mesh improved.
#pragma once

#include <cstddef>

#include "tetra/detail/guide_surface.h"
#include "tetra/detail/local_cells.h"

namespace innermap {

struct ShapePassSettings {
  double least = 0.2;  // sine; below it a tetrahedron is poor
  bool connect = true;
  int passes = 6;
};

struct ShapePassResult {
  std::size_t swaps = 0, collapses = 0;
};

ShapePassResult improveShapes(const GuideSurface& surface, const ShapePassSettings& settings,
                              LocalCells& cells);

}  // namespace innermap
