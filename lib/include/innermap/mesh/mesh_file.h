// Mesh files in: OBJ, PLY, OFF, STL.
//
// The readers are our own. For PLY, OFF and STL no packaged reader keeps non-manifold faces, reads
// triangle strips and refuses a header that promises more than the file holds before memory is
// allocated for it. For OBJ the packaged tinyobjloader holds coordinates as floats, reads malformed
// numbers as zeros and does not refuse negative indices below the first vertex.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

// ".obj" and so on, of the files that readMesh reads.
const std::vector<std::string>& meshExtensions();

// Reads by the extension (case-insensitive) .obj, .ply, .off, .stl.
//
// Vertices keep the file's order and number, loose ones included. STL corners are welded where
// their coordinates are equal bit by bit, in order of first appearance (STL has no connectivity).
// Convex polygons are cut as a fan from their lowest vertex index, others by ear clipping in their
// mean plane. A polygon of fewer than three corners is an error.
//
// OBJ: v (with optional colour), vt, f with negative indices; groups and materials are ignored.
// PLY: ASCII, binary little and big endian, any numeric types; vertex x y z, red green blue (uchar
// or float), s t / u v; face vertex_indices or vertex_index; tristrips.
// OFF: OFF, COFF, NOFF, STOFF and comments. STL: ASCII and binary, told apart by size.
//
// Throws FileError: missing file, unknown extension, wrong or truncated content (with the line or
// byte), counts beyond the file's size, indices out of range, NaN or infinite coordinates, no
// vertices or no faces. Colours are clamped to [0, 1].
Mesh readMesh(const std::string& path);

// Reads a mesh that must have the connectivity of `reference` (a pose, the target of a map) and
// takes over the reference's triangulation, so that a polygon is cut alike in all frames.
// Throws as readMesh; DataError when the number of vertices or any polygon differs, naming the
// first difference and saying that meshes of other connectivity need a correspondence first
// (surface/correspond.h).
Mesh readMeshLike(const std::string& path, const Mesh& reference);

struct TargetMesh {
  Mesh mesh;
  bool related = true;  // of the source's connectivity
};

// What a source is to be mapped onto: as readMeshLike() where the connectivity is the same, else as
// readMesh(). Throws FileError.
TargetMesh readTarget(const std::string& path, const Mesh& source);

// Mesh files out.

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
