// Shaded pictures of surfaces, coloured point by point.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "innermap/boundary/mapped_solid.h"
#include "innermap/boundary/mesh_correspondence.h"
#include "innermap/core/vec3.h"

namespace innermap {

// A point of a surface that the picture shows.
struct VisiblePoint {
  int triangle = 0;
  std::array<double, 3> barycentric{};
};

struct PictureSurface {
  std::string label;  // written above it
  Points vertices;
  std::vector<std::array<int, 3>> triangles;  // indices into vertices
  // The colours (linear, 0..1, before shading) of the points seen; as many as are asked for.
  std::function<std::vector<Vec3>(const std::vector<VisiblePoint>&)> colours;
};

struct MeshPictureSettings {
  int pixels = 480;  // each view's height, in [64, 4096]
  // Where the viewer stands as seen from the surfaces' middles (any length above 0), one row of
  // views each; y is up. More than one direction shows what is hidden from the first.
  std::vector<Vec3> from{{0.6, 0.35, 1}, {-0.6, 0.35, -1}};
  std::string caption;  // below all
};

// Draws the surfaces side by side, each fitted to its place, in parallel projection, to a PNG.
// Triangles are seen from both sides. Deterministic. Throws FileError, SettingError, DataError
// when there is nothing to show; Cancelled. The file appears whole or not at all.
void writeMeshPicture(const std::string& path, const std::vector<PictureSurface>& surfaces,
                      const MeshPictureSettings& settings = {});

// Need of each of the functions here in bytes, beside the surfaces.
std::uint64_t meshPictureMemory(const MeshPictureSettings& settings = {});

// A's coordinates as colours, with a chequered pattern in which stretch shows, on A and on B side
// by side. B is coloured point by point by where the map comes from, not vertex by vertex. Throws
// as writeMeshPicture.
void writeCorrespondencePicture(const std::string& path, const MeshCorrespondence& map,
                                const MeshPictureSettings& settings = {});

// A solid's surface as the steps of its map carry it, side by side, at most seven of them, with the
// source's coordinates as colours. Throws as writeMeshPicture.
void writeStepsPicture(const std::string& path, const MappedSolid& mapped,
                       const MeshPictureSettings& settings = {});

}  // namespace innermap
