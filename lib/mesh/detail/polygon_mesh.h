// What the file readers make, before polygons are cut into triangles.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/file_bytes.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

struct PolygonMesh {
  Points vertices;
  std::vector<int> start{0};  // polygon p has corners [start[p], start[p + 1])
  std::vector<int> corners;   // vertices, all in range
  std::vector<Vec2> uvs;
  std::vector<int> uvCorners;  // as corners, indices into uvs or -1; empty without uvs
  std::vector<std::array<float, 3>> colours;

  std::size_t polygons() const { return start.size() - 1; }
};

// Each throws FileError. Vertices are finite, indices in range, polygons have three corners or
// more.
PolygonMesh readObj(const FileBytes& file);
PolygonMesh readPly(const FileBytes& file);
PolygonMesh readOff(const FileBytes& file);
PolygonMesh readStl(const FileBytes& file);

// Clamps to [0, 1]; NaN becomes 0.
std::array<float, 3> clampedColour(double red, double green, double blue);

// Cuts the polygons into triangles.
Mesh toMesh(PolygonMesh&& polygons, const std::string& path);

// Takes over the reference's polygons and triangles. Throws DataError, as readMeshLike.
Mesh toMeshLike(PolygonMesh&& polygons, const std::string& path, const Mesh& reference);

}  // namespace innermap
