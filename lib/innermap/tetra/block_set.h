// Sets of equal cubes of a lattice: what a polycube is made of.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/lattice/cell_mesh.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

using Block = std::array<int, 3>;

// The outermost layer of the lattice is empty, so that every filled block has all its neighbours.
struct BlockSet {
  Vec3 lower;                 // corner of block (0, 0, 0), world units
  double edge = 1;            // of a block, world units
  std::array<int, 3> size{};  // blocks along each axis
  std::vector<char> filled;   // size[0] * size[1] * size[2], x fastest

  std::size_t index(const Block& b) const {
    return (static_cast<std::size_t>(b[2]) * static_cast<std::size_t>(size[1]) +
            static_cast<std::size_t>(b[1])) *
               static_cast<std::size_t>(size[0]) +
           static_cast<std::size_t>(b[0]);
  }
  Block block(std::size_t index) const;
  bool at(const Block& b) const { return filled[index(b)] != 0; }
  std::size_t count() const;  // filled blocks
};

// The boundary as triangles: each face of a filled block beside an empty one is cut in `pieces`^2
// squares of two triangles. Closed and outward; manifold where the set is. pieces in [1, 1000].
// Throws SettingError.
Mesh blockSurface(const BlockSet& blocks, int pieces);

// Pieces with which that has about 3000 vertices or more, enough to be mapped; at most
// kMostBlockPieces.
constexpr int kMostBlockPieces = 64;
int usualPieces(const BlockSet& blocks);

// The set as hexahedra, in the shape of the blocks.
struct BlockHexahedra {
  CellMesh mesh;
  std::size_t core = 0;  // hexahedra in the blocks: first of all; those of the layer follow
  // A vertex on the set's boundary and the one that stands below it, under the pillow layer.
  struct Skin {
    int outer, inner;
  };
  std::vector<Skin> skin;  // every vertex of the boundary, once
};

// Each block as pieces^3 hexahedra, and around them a layer of one more hexahedron on each square
// of the boundary ("pillow": without it two faces of one hexahedron may lie in one plane). The
// layer takes `pillow` of a piece, inwards. The set must be manifold. pieces in [1, 1000], pillow
// in (0, 1). Throws SettingError.
BlockHexahedra blockHexahedra(const BlockSet& blocks, int pieces, double pillow = 0.4);

}  // namespace innermap
