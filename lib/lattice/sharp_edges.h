// Sharp edges of a surface as curves, and a mesh's boundary drawn onto them.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "innermap/levelset/solid.h"
#include "innermap/mesh/mesh.h"
#include "lattice/stuffing.h"

namespace innermap {

struct SharpCurve {
  Points points;                       // in order; the first again at the end of a closed one
  std::array<int, 2> corners{-1, -1};  // where it starts and ends; -1: closed
  double length = 0;
};

struct SharpEdges {
  Points corners;  // where other than two sharp edges meet, or two that turn
  std::vector<SharpCurve> curves;
};

// Edges whose two triangles' normals differ by more than `angle` degrees; vertices in one place
// count as one.
SharpEdges sharpEdges(const Mesh& surface, double angle);

struct SharpFit {
  std::size_t curves = 0, kept = 0;  // kept: with a path of the mesh's edges along it
  double rms = 0, max = 0;           // from points of all curves to the paths' edges, world units
};

// With sharp edges, dihedral angles may go as far as these.
constexpr double kLeastSharpDihedral = 5, kGreatestSharpDihedral = 170;  // degrees

// Corners take the nearest boundary vertex, each curve the cheapest path of boundary edges; these
// are drawn onto them while the shapes about them are kept good (untangle.h), as far as the angles
// allow. After fitBoundary().
SharpFit fitSharpEdges(const Solid& solid, const SharpEdges& sharp, double spacing,
                       StuffedMesh& mesh);

}  // namespace innermap
