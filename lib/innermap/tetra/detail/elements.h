// Harmonic functions by finite elements, as functions of the points inside.
#pragma once

#include <array>
#include <functional>
#include <memory>

#include "innermap/core/matrix.h"
#include "innermap/levelset/solid.h"
#include "innermap/tetra/cell_locator.h"
#include "innermap/tetra/cell_mesh.h"
#include "innermap/tetra/compare_fem.h"

namespace innermap {

struct Elements {
  CellMesh mesh;
  Matrix values;  // #V x 3
  std::unique_ptr<CellLocator> locator;
};

// With the values of `boundary` at the vertices of the boundary. Sets the row's size, edge,
// unknowns, iterations, seconds and memory.
Elements solveElements(const Solid& solid, const std::function<Vec3(const Vec3&)>& boundary,
                       int resolution, const CompareFemSettings& settings, ComparedRow& row);

// Of the three channels: gradient[3 k + axis].
std::array<double, 9> gradientIn(const Elements& elements, int cell);

// Of gradients over the faces of some thousand cells, evenly spread among all: root mean square,
// relative; of all channels together or of the worst.
double jumpOf(const Elements& elements, bool together);

InsideFunction functionOf(std::shared_ptr<const Elements> elements);

// From sums of squares of the three channels.
double relativeError(const Vec3& errors, const Vec3& sizes, bool together);

}  // namespace innermap
