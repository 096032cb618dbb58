// A source split until its image follows the target.
#pragma once

#include <vector>

#include "innermap/surface/correspond.h"
#include "surface/detail/refining/target_metric.h"

namespace innermap {

// The mesh that a shell's triangles are of, split along with them.
struct SplitMesh {
  Mesh mesh;
  std::vector<ShellVertex> shellVertex;        // #V of mesh
  std::vector<std::vector<int>> meshTriangle;  // for each shell, each triangle's number in mesh
};

// A shell of the mesh and where it lies.
struct SplitShell {
  int number = 0;          // in SplitMesh::meshTriangle
  ClosedSurface& surface;  // grows
  Layout& image;           // of it, on the model space of the target; grows
  const ClosedSurface& target;
  const Layout& targetLayout;
};

struct SubdivideSettings {
  double tolerance = 0.005;         // of the target's diagonal, above 0
  std::size_t triangles = 4000000;  // most
};

struct Subdivided {
  std::size_t added = 0;  // vertices
  bool enough = true;     // false: the most triangles were reached first
};

// Splits the longest edges (on the model space) of triangles whose flat images are farther than the
// tolerance from the target, or that the target's vertices between their corners are farther from,
// then, where the target does not cross itself, of those whose flat images cross; and relaxes
// around the new vertices. split.mesh grows with the shell: its own vertices and triangles stay
// first and keep their numbers. Throws Cancelled.
Subdivided subdivide(const SplitShell& shell, const TargetMetric& target, SplitMesh& split,
                     const SubdivideSettings& settings);

}  // namespace innermap
