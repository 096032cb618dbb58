// Files of geometry that is carried through maps: read, carried, written again as they were but for
// what moves.
//
//   .obj   v, vn, f, l and p move or are renumbered; all else (texture coordinates, groups,
//          materials, colours, comments) stays byte for byte. A normal that several points share is
//          split, as each of them turns it otherwise
//   .ply   ASCII and binary, with all elements and properties in their types; x y z and nx ny nz
//          move, and vectors that are named: NAME_x NAME_y NAME_z. With scale_0..2, rot_0..3 and
//          opacity vertices are Gaussian splats, see transfer/geometry.h: these and the colours'
//          f_rest_* (0, 9, 24 or 45) move too
//   .off   x y z and, in NOFF, normals
//   .stl   ASCII and binary, with normals and attributes
//   .vtu .msh .mesh   tetrahedra and hexahedra with fields, see io/cell_file.h; these may be
//          written as one another
//
// Coordinates are written so that they read back to the same double, but where the file keeps
// floats (binary .stl, .ply properties of that type).
#pragma once

#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/fit/fit_harmonic.h"
#include "innermap/mesh/mesh.h"
#include "innermap/transfer/geometry.h"

namespace innermap {

struct ReadGeometrySettings {
  // Names of vectors and of normals among the properties or fields of points and cells, beside
  // those that the file's format knows as such.
  std::vector<std::string> vectors, normals;
};

// A geometry and the file that it came from.
class GeometryFile {
 public:
  virtual ~GeometryFile() = default;

  Geometry geometry;
  std::vector<std::string> notes;  // what was left out on reading

  virtual InvertedCells inverted(const CarriedGeometry&) const { return {}; }

  // Splats whose opacity SplatOpacity::mass would have grown above its limit.
  virtual std::uint64_t cappedOpacities(const CarriedGeometry&) const { return 0; }

  // The file with what was carried. Returns names of fields that `path`'s format cannot hold.
  virtual std::vector<std::string> write(const std::string& path, const CarriedGeometry& carried,
                                         std::ostream& stream) const = 0;
};

// Whether the path ends as one of these files does, in any case of letters.
bool isGeometryFile(const std::string& path);

// Throws FileError when a file of the one cannot be written as the other.
void requireWritableAs(const std::string& input, const std::string& output);

// Throws FileError for content that is wrong or cut short, counts beyond the file's size, indices
// out of range, coordinates that are not finite, a name of a vector that is not there, splats that
// lack a property, quaternions of length 0, scales or colours that are not finite; MemoryError;
// Cancelled.
std::unique_ptr<GeometryFile> readGeometry(const std::string& path,
                                           const ReadGeometrySettings& settings = {});

// Peak need in bytes of reading and carrying the file, from its size. Throws FileError when there
// is none.
std::uint64_t geometryMemory(const std::string& path);

// The file's geometry, carried, with what the file counts. Throws as carryGeometry() of
// transfer/geometry.h; MemoryError.
CarriedGeometry carryGeometry(GeometryFile& file, const PointCarry& carry,
                              const CarryGeometrySettings& settings = {});

// What of the file was carried. It appears whole or not at all. Returns as GeometryFile::write.
// Throws FileError.
std::vector<std::string> writeGeometry(const std::string& path, const GeometryFile& file,
                                       const CarriedGeometry& carried);

// What files say about parts of a surface and about its vertices, beside their places: groups of
// triangles, properties, tables.

// Groups (g, which may give a face several names), objects (o) and materials (usemtl) of an OBJ, by
// name, in the order in which they come; what bears a name in any of these ways belongs to it.
// mesh: read from the same file. Throws FileError for what is no OBJ or has other faces than the
// mesh; Cancelled.
std::vector<SurfaceGroup> readGroups(const std::string& path, const Mesh& mesh);

// Numbers of the vertices of a PLY, by the names of their properties: #vertices x #names. mesh:
// read from the same file. Throws FileError for what is no PLY, a name that is not there (saying
// which are), other numbers of vertices; Cancelled.
Matrix readVertexProperties(const std::string& path, const std::vector<std::string>& names,
                            const Mesh& mesh);

// A table of vertices: a line "VERTEX VALUE..." each, vertices counted from 0, parted by commas,
// semicolons or blanks; '#' starts a comment; the first line may name the columns.
struct VertexTable {
  std::vector<std::string> names;  // of the columns after the first; empty when the file has none
  Matrix values;                   // #vertices x #columns; NaN in rows that the table lacks
};

// Throws FileError with the line for what is no number, lines of unlike length, vertices out of
// range or given twice; Cancelled.
VertexTable readVertexTable(const std::string& path, const Mesh& mesh);

}  // namespace innermap
