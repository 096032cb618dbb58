// Files of tetrahedra and hexahedra, with fields on points and cells, in and out:
//
//   .vtu   VTK's XML unstructured grid (ParaView, PyVista): ASCII, base64 and appended data, plain
//          or compressed with zlib, either byte order; written as base64, Float64
//   .msh   Gmsh's format 4.1, ASCII and binary, and 2.2, both too; written as 4.1 binary, doubles
//   .mesh  MEDIT's format (INRIA), ASCII; written with as many digits as give the same double again
//
// So each of them keeps vertices as they are, and what is proven of cells (tetra/cells.h) is of
// those in the file. Readers that take floats round them anew.
//
// The readers are our own: the packaged ones (VTK, meshio, Gmsh) trust counts, or are GPL, or need
// a toolkit of hundreds of megabytes. Input is untrusted: every count is compared with the bytes
// that are there before memory is allocated, every index with what it points into.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "innermap/lattice/cell_mesh.h"

namespace innermap {

// Whether the path ends as one of these files does, in any case of letters.
bool isCellFile(const std::string& path);

struct CellFile {
  CellMesh mesh;
  // What the file has and the mesh does not (triangles of the boundary, names of groups), one line
  // each with its count.
  std::vector<std::string> notes;
};

// Vertices keep the file's order and number, loose ones included; so do the cells, tetrahedra
// first. Numbers keep their precision; whole numbers are marked so (CellField::whole).
//
// Kinds of fields: .vtu says which array is its vectors and which its normals (attributes `Vectors`
// and `Normals`; writeCells adds `Kind` to each array), Gmsh's fields of three components are
// vectors; all others are scalars. References of MEDIT become whole fields "medit:ref"; Gmsh's
// physical groups and entities become "gmsh:physical" and "gmsh:geometrical" on cells, the names
// that meshio uses, and are written back as such. Rows that a Gmsh field lacks are NaN.
//
// Points, lines, triangles and quadrilaterals are counted in a note and left out. Throws FileError
// for other cells (wedges, pyramids, polyhedra, voxels, higher order), for content that is wrong or
// cut short (with the line, byte or array), counts beyond the file's size, indices out of range,
// coordinates that are not finite, no tetrahedra or hexahedra; DataError as validate(); MemoryError
// when what the file holds, as its size or its compressed arrays tell, exceeds the limit;
// Cancelled.
CellFile readCells(const std::string& path);

// Peak need in bytes of reading the file, from its size; compressed ones may need more, which
// readCells then checks. Throws FileError when there is no such file.
std::uint64_t readCellsMemory(const std::string& path);

// The file appears whole or not at all. Returns the names of fields that the format cannot hold,
// which were left out: all but "medit:ref" for .mesh, those of over nine components for .msh (of
// which those of 2 and 4 to 8 get zeros up to 3 and 9). Rows of NaN are left out of .msh. Throws
// FileError; DataError as validate().
std::vector<std::string> writeCells(const std::string& path, const CellMesh& mesh);

}  // namespace innermap
