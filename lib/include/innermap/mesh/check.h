// What is wrong with a mesh, and what each finding means for a map.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

// Pairs of triangles of one mesh that pass through each other.

struct Crossing {
  int first = 0, second = 0;  // triangles that intersect each other
  Vec3 place;                 // a point near the intersection, world units
};

// All pairs (first < second, sorted) of triangles that intersect in more than what they share:
// pairs with a common edge count only when folded flat onto each other (coplanar overlap), pairs
// with a common vertex when they intersect away from it, pairs with three common vertices never.
// Vertices are common when their positions are equal bit by bit. Touching in a point or along an
// edge without passing through may or may not be counted. Degenerate triangles are left out.
// Interval overlap method, Moller, "A Fast Triangle-Triangle Intersection Test" (1997), in double
// precision. Throws Cancelled.
std::vector<Crossing> selfIntersections(const Points& vertices,
                                        const std::vector<Triangle>& triangles);

// The same, one at a time in an order that is the same for any number of threads, for meshes whose
// crossings would not fit in memory.
void forEachSelfIntersection(const Points& vertices, const std::vector<Triangle>& triangles,
                             const std::function<void(const Crossing&)>& visit);

struct BoundaryLoop {
  std::vector<int> vertices;  // in order along the loop
  double length = 0;          // world units
};

// Connectivity is the file's own, by vertex index; only seamEdges, openLoops, volume and genus look
// at positions.
struct MeshReport {
  std::size_t vertices = 0, triangles = 0, polygons = 0;
  int components = 0;  // connected by shared vertices; loose vertices do not count
  std::vector<BoundaryLoop> boundaryLoops;  // of edges with an odd number of triangles
  // Boundary edges that coincide bit by bit with one that runs the other way: files double vertices
  // where texture or normals jump, and the solid does not end there.
  std::size_t seamEdges = 0;
  std::size_t openLoops = 0;  // loops that remain when seams are joined: repair caps them
  std::vector<std::array<int, 2>> nonManifoldEdges;  // shared by three triangles or more
  std::vector<int> nonManifoldVertices;              // whose triangles form more than one fan
  std::vector<int> duplicateTriangles;   // same three vertices, same orientation, as an earlier one
  std::vector<int> oppositeTriangles;    // same three vertices, other orientation
  std::vector<int> degenerateTriangles;  // repeated vertex, or height under 1e-12 of the diagonal
  std::size_t oneSidedEdges = 0;         // where no orientation agrees: the surface is one-sided
  std::size_t inconsistentEdges = 0;     // both triangles run along it in the same direction
  std::vector<int> looseVertices;
  std::size_t selfIntersections = 0;  // pairs of triangles
  std::vector<Crossing> crossings;    // the first `listed` of them
  bool outward = true;                // signed volume (holes capped) is not negative
  bool closed = true;                 // no boundary loop
  // Handles: sum over components of (2 - Euler characteristic - boundary loops) / 2, with seams
  // joined and the surface cut apart where parts touch in a vertex only. Meaningless where edges
  // are not manifold.
  int genus = 0;
  double area = 0;    // world units squared
  double volume = 0;  // signed, with the holes capped; world units cubed
  Box3 box;
};

struct CheckSettings {
  bool selfIntersections = true;
  std::size_t listed = 20;  // crossings that are placed; all are counted
};

// Throws Cancelled; DataError as validate().
MeshReport checkMesh(const Mesh& mesh, const CheckSettings& settings = {});

// Peak need in bytes of checkMesh, an upper bound.
std::uint64_t checkMemory(const Mesh& mesh);

struct Finding {
  std::string name;  // "boundary_loops"
  std::size_t count = 0;
  std::string what;     // "2 boundary loops, the longest 0.0131 long around vertex 4120"
  std::string meaning;  // "the solid is closed by caps there; ..."
};

// The findings worth telling, most serious first; empty for a clean closed mesh.
std::vector<Finding> findings(const MeshReport& report);

// From a mesh as it comes to one that bounds a solid: loose vertices, duplicate triangles and those
// with a repeated vertex are left out, orientation is made consistent and outward, holes are
// capped.

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

// Where a mesh was open: the boxes of the caps that repair() closed it with.

// One box a cap, in the order of the caps; world units.
std::vector<Box3> capBoxes(const RepairedMesh& repaired);

// The same at other positions, of all vertices of repaired.mesh (repairedPositions()).
std::vector<Box3> capBoxes(const RepairedMesh& repaired, const Points& positions);

// The same where caps follow so many vertices and triangles of the mesh's own, as in
// SurfaceShells::mesh.
std::vector<Box3> capBoxes(const Points& vertices, const std::vector<Triangle>& triangles,
                           std::size_t ownVertices, std::size_t ownTriangles);

}  // namespace innermap
