// Triangle meshes as innermap keeps them: the file's vertices in the file's order (correspondences
// between meshes live in it), its polygons, and one triangulation of them.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "innermap/core/vec3.h"

namespace innermap {

using Triangle = std::array<int, 3>;

struct Mesh {
  std::string name;                 // the file's path, or what error messages should call it
  Points vertices;                  // #V, world units
  std::vector<Triangle> triangles;  // #T, indices into vertices

  // The polygons that the triangles came from: polygon p has corners
  // polygonCorners[polygonStart[p] .. polygonStart[p + 1]). Empty when the mesh was made of
  // triangles to begin with.
  std::vector<int> polygonStart;    // #P + 1, or empty
  std::vector<int> polygonCorners;  // indices into vertices

  // Texture coordinates per corner: triangle t has uvs[uvTriangles[t][k]] at corner k; -1 where a
  // corner has none. Both empty when the file has none.
  std::vector<Vec2> uvs;
  std::vector<Triangle> uvTriangles;  // #T or empty

  std::vector<std::array<float, 3>> colours;  // #V or empty; linear or not as in the file, 0..1
};

// A point of a surface by address: it moves with the mesh.
struct SurfacePoint {
  int triangle = 0;
  std::array<double, 3> barycentric{1, 0, 0};  // sums to 1
};

// Throws DataError when a triangle index is out of [0, #V), a vertex that a triangle uses is not
// finite, or an attribute array has the wrong size; the message names mesh.name.
void validate(const Mesh& mesh);

Vec3 positionOf(const Mesh& mesh, const SurfacePoint& point);

// Interpolates any per-vertex positions (a target's, say) at surface points. #points.
// positions has one entry for each vertex that `triangles` refers to.
Points interpolate(const Points& positions, const std::vector<Triangle>& triangles,
                   const std::vector<SurfacePoint>& points);

// (b - a) x (c - a) / 2: area times unit normal.
Vec3 areaVector(const Mesh& mesh, int triangle);

// Of the vertices that triangles use; loose vertices do not count.
Box3 boundingBox(const Mesh& mesh);

// How far from the origin a mesh may lie, in its own diagonals: beyond, doubles hold its positions
// less exactly than innermap computes (1e-8 of the diagonal there).
constexpr double kMostFromOrigin = 1e8;

// Throws DataError when a vertex that a triangle uses is farther than that from the origin along an
// axis. What is read from files, solids and targets are held to it.
void requireNearOrigin(const Mesh& mesh);

double surfaceArea(const Mesh& mesh);  // world units squared
double surfaceArea(const Points& vertices, const std::vector<Triangle>& triangles);

// Signed volume by the divergence theorem, sum of det(a, b, c) / 6 about the box's centre; exact
// for a closed, outward oriented mesh, positive then. World units cubed.
double signedVolume(const Mesh& mesh);
double signedVolume(const Points& vertices, const std::vector<Triangle>& triangles);

}  // namespace innermap
