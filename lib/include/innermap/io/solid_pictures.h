// Shaded pictures of surfaces and of cells, and of functions on a plane through a solid.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/correspond/mesh_correspondence.h"
#include "innermap/fit/mapped_solid.h"
#include "innermap/io/pictures.h"
#include "innermap/lattice/cell_mesh.h"

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

// Pictures of meshes of tetrahedra and hexahedra, cut open.

struct CellPictureSettings {
  // Cells whose middle is farther this way than the cut are left out, so that the others show.
  Vec3 direction{0, 0, 1};    // any length above 0; the viewer stands there, a little to the side
  double at = 0.5;            // where the cut is, from 0 to 1 through the mesh's box
  double blue = 60, red = 0;  // the values of the ends of the colours; different
  Colormap colormap = Colormap::redBlue;
  std::string label;    // above it
  std::string caption;  // below it
  int pixels = 900;     // height of the view, in [64, 4096]
};

// Draws the cells, whole, each in the colour of its value, with their edges, to a PNG. values: #T +
// #H. The file appears whole or not at all. Throws DataError when sizes disagree or nothing is left
// to show, SettingError, FileError, Cancelled.
void writeCellPicture(const std::string& path, const CellMesh& mesh,
                      const std::vector<double>& values, const CellPictureSettings& settings = {});

// Functions on a plane through a solid, side by side.

struct PlaneFunction {
  std::string label;  // above it
  // Values at points of the plane; one that is not finite is left blank.
  std::function<std::vector<double>(const Points&)> values;
};

struct PlanePictureSettings {
  int axis = 2;              // the plane is across it: 0, 1, 2
  double at = 0.5;           // fraction of the box along the axis, in [0, 1]
  double blue = 0, red = 1;  // the values of the ends of the colours; different
  Colormap colormap = Colormap::redBlue;
  std::string caption;  // below all
  int pixels = 480;     // each view's height, in [64, 4096]
};

// Writes a PNG; the file appears whole or not at all. Throws DataError when there is no function or
// no box, SettingError, FileError, Cancelled.
void writePlanePicture(const std::string& path, const Box3& box,
                       const std::vector<PlaneFunction>& functions,
                       const PlanePictureSettings& settings = {});

}  // namespace innermap
