// From a mesh as it comes to one that bounds a solid: loose vertices, duplicate triangles and those
// with a repeated vertex are left out, orientation is made consistent and outward, holes are
// capped.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

// A vertex that repair adds: a weighted mean of the mesh's own, so that it moves with them.
struct CapVertex {
  std::vector<std::pair<int, double>> weights;  // (vertex, weight), weights sum to 1
};

struct RepairedMesh {
  // The first vertices are those of the input, in its order (loose ones included, unused); cap
  // vertices follow. Every edge has as many triangles one way as the other (vertices at the same
  // place along a seam counted as one), so winding numbers are whole numbers.
  Mesh mesh;
  std::vector<CapVertex> capVertices;
  std::vector<int> parent;         // #T: the input's triangle, or -1 for a cap's
  int caps = 0;                    // boundary loops closed
  std::vector<std::string> notes;  // what was repaired, a line each; empty when nothing was
};

// Caps: the boundary of the oriented triangles is a sum of directed loops (each edge counted as
// often as it runs one way more than the other), also on non-manifold meshes. A loop of three edges
// gets one triangle, longer ones a fan about their length-weighted centroid. Orientation:
// neighbours over edges of two triangles are made to agree; a component whose inside then has
// winding number -1 is turned; an inner shell that bounds a cavity is kept. Throws DataError when
// no solid remains ("has no inside"): every triangle degenerate, a surface with one side, or a
// volume enclosed by the repaired mesh not above 1e-12 of its area times the diagonal, which is
// what rounding leaves of it. Also for a diagonal whose cube is no number.
//
// Triangles without area but with three vertices are kept: they hold the surface together. Seams,
// where files double vertices along texture borders, are joined where two boundary edges coincide
// bit by bit; caps never close them.
RepairedMesh repair(const Mesh& mesh);

// The same repair on other positions of the same connectivity (a target, a frame): positions of
// all vertices of repaired.mesh, cap vertices included. `vertices` has as many entries as the mesh
// that was repaired; throws DataError otherwise.
Points repairedPositions(const RepairedMesh& repaired, const Points& vertices);

}  // namespace innermap
