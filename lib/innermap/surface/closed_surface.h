// The shells of a solid's boundary, ready to be mapped: each closed, connected, manifold, oriented.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "innermap/mesh/mesh.h"
#include "innermap/surface/layout.h"

namespace innermap {

// A vertex of one of several shells.
struct ShellVertex {
  int shell = -1, vertex = -1;  // -1: none (loose vertices)
};

// A mesh taken apart. Vertices that the file split along texture seams are one.
struct SurfaceShells {
  // Vertices: the mesh's own in its order, then the caps', then one for each further fan of a
  // vertex where parts touch. Triangles: the mesh's own in its order, turned where that was needed
  // to be outward, then the caps'. Triangles that are in no shell (duplicates, with a repeated
  // vertex, of parts that enclose nothing) stay in it.
  Mesh mesh;
  std::vector<ClosedSurface> shells;     // in order of their first triangles
  std::vector<int> parent;               // #shells: the shell directly around it, or -1
  std::vector<ShellVertex> shellVertex;  // for each vertex of mesh
  // For each shell, each triangle's number in mesh; corner k is the same corner in both.
  std::vector<std::vector<int>> meshTriangle;
  std::vector<bool> turned;        // for each triangle of mesh: the file's runs the other way
  std::size_t splitVertices = 0;   // added for further fans
  int caps = 0;                    // boundary loops closed
  std::vector<std::string> notes;  // what was repaired, a line each
};

struct ClosedSurfaceSettings {
  bool closeHoles = false;  // cap boundary loops (mesh/repair.h); otherwise they are an error
};

// Throws DataError: holes (their number and the longest) without consent to close them, edges of
// more than two triangles (the first few named by their vertices), one-sided surfaces, a mesh with
// no inside or in one plane; Cancelled. Vertices where parts merely touch are split: each fan gets
// one of its own. Parts that overlap one another stay shells of their own; a shell is inside
// another when most of it is.
SurfaceShells closedSurfaces(const Mesh& mesh, const ClosedSurfaceSettings& settings = {});

}  // namespace innermap
