// The shells of a solid's boundary, ready to be mapped: each closed, connected, manifold, oriented.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "innermap/core/progress.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

struct ClosedSurface {
  std::string name;                 // what error messages should call it
  Points vertices;                  // #V, world units; each is used by some triangle
  std::vector<Triangle> triangles;  // #T; each edge has two, running opposite ways; outward of the
                                    // solid (so a cavity's shell has a negative volume)
  int genus = 0;                    // handles: #V - #E + #T = 2 - 2 genus
};

// A vertex of one of several shells.
struct ShellVertex {
  int shell = -1, vertex = -1;  // -1: none (loose vertices)
};

// A mesh taken apart. Vertices that the file split along texture seams are one.
struct SurfaceShells {
  Mesh mesh;                                   // as given, or repaired where holes were capped
  std::vector<ClosedSurface> shells;           // in order of their first triangles
  std::vector<int> parent;                     // #shells: the shell directly around it, or -1
  std::vector<ShellVertex> shellVertex;        // for each vertex of mesh
  std::vector<std::vector<int>> meshTriangle;  // for each shell, each triangle's number in mesh
  int caps = 0;                                // boundary loops closed
  std::vector<std::string> notes;              // what was repaired, a line each
};

struct ClosedSurfaceSettings {
  bool closeHoles = false;  // cap boundary loops (mesh/repair.h); otherwise they are an error
  Progress* progress = nullptr;
};

// Throws DataError: holes (their number and the longest) without consent to close them, edges of
// more than two triangles (the first few named by their vertices), a mesh with no inside or in one
// plane; Cancelled. Vertices where parts merely touch are split: each fan gets one of its own.
SurfaceShells closedSurfaces(const Mesh& mesh, const ClosedSurfaceSettings& settings = {});

}  // namespace innermap
