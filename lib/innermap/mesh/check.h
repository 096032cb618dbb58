// What is wrong with a mesh, and what each finding means for a map.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "innermap/mesh/mesh.h"
#include "innermap/mesh/self_intersection.h"

namespace innermap {

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

}  // namespace innermap
