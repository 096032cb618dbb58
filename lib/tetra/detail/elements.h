// Harmonic functions by finite elements, as functions of the points inside.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>

#include "innermap/core/matrix.h"
#include "innermap/lattice/cell_mesh.h"
#include "innermap/levelset/solid.h"
#include "transfer/cell_locator.h"

namespace innermap {

struct FiniteElements {
  CellMesh mesh;
  Matrix values;  // #V x 3
  std::unique_ptr<CellLocator> locator;
  double edge = 0;  // of the tetrahedra's lattice, world units
  std::size_t unknowns = 0;
  int iterations = 0;
  double seconds = 0;        // wall time without the locator
  std::uint64_t memory = 0;  // bytes, by harmonicCellsMemory
};

struct ElementsSettings {
  int resolution = 64;  // as TetrahedralizeSettings
};

// With the values of `boundary` at the vertices of the boundary.
FiniteElements solveElements(const Solid& solid, const std::function<Vec3(const Vec3&)>& boundary,
                             const ElementsSettings& settings);

// Of the three channels: gradient[3 k + axis].
std::array<double, 9> gradientIn(const FiniteElements& elements, int cell);

// Of gradients over the faces of some thousand cells, evenly spread among all: root mean square,
// relative; of all channels together or of the worst.
double jumpOf(const FiniteElements& elements, bool together);

// From sums of squares of the three channels.
double relativeError(const Vec3& errors, const Vec3& sizes, bool together);

}  // namespace innermap
