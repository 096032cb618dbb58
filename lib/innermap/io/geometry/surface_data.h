// What files say about parts of a surface and about its vertices, beside their places: groups of
// triangles, properties, tables.
#pragma once

#include <string>
#include <vector>

#include "innermap/boundary/boundary_conditions.h"
#include "innermap/core/matrix.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

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
