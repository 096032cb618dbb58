// Mesh files out.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

// Writes .ply (binary little endian, double) or .obj (digits that read back to the same number) by
// the extension: vertices, triangles, vertex colours (in .ply 8 bits each); OBJ also texture
// coordinates. The file appears whole or not at all. Throws FileError.
void writeMesh(const std::string& path, const Mesh& mesh);

// A number for each vertex, beside its place.
struct VertexProperty {
  std::string name;                                                     // one word, as in the file
  std::variant<std::vector<std::int32_t>, std::vector<double>> values;  // #V; `int` or `double`
};

struct PlyExtras {
  std::string comment;                     // one line of the header; empty: none
  std::vector<VertexProperty> properties;  // after the place and the colour, in this order
};

// As writeMesh() writes .ply, with further properties of the vertices. Throws DataError for a
// property that has not a number for each vertex; FileError.
void writePly(const std::string& path, const Mesh& mesh, const PlyExtras& extras);

}  // namespace innermap
