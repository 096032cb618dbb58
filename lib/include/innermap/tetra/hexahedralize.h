// Fills a solid with hexahedra by way of a polycube: cuts its blocks into hexahedra, adds a layer
// around them, carries all by a map of the polycube onto the solid, and moves vertices there until
// each hexahedron is proven right side out.
//
// After Li, Guo, Wang, He, Gu and Qin, "Meshless Harmonic Volumetric Mapping Using Fundamental
// Solution Methods" (IEEE T-ASE 6(3), 2009), who map polycubes, and Gregson, Sheffer and Zhang,
// "All-hex mesh generation via volumetric polycube deformation" (SGP 2011).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "innermap/core/run.h"
#include "innermap/core/setting.h"
#include "innermap/core/vec3.h"
#include "innermap/lattice/cell_mesh.h"
#include "innermap/levelset/solid.h"
#include "innermap/mesh/mesh.h"
#include "innermap/surface/correspond.h"
#include "innermap/tetra/cells.h"

namespace innermap {

// How near the boundary of a mesh of cells is to the surface of a solid.

// Fractions of the solid's diagonal.
struct SurfaceDistance {
  double rms = 0, max = 0;
};

struct BoundaryFit {
  SurfaceDistance toSurface;    // from samples of the mesh's boundary to the solid's surface
  SurfaceDistance fromSurface;  // and the other way
  std::size_t faces = 0;        // triangles of the boundary; a quadrilateral counts as two
  std::size_t inward = 0;  // that face against the surface at the point closest to their middle
};

struct BoundaryFitSettings {
  std::size_t samples = 20000;  // each way, at least 1
  std::uint64_t seed = 1;
  // boundaryTriangles() of the mesh; empty or none: they are looked for.
  const std::vector<Triangle>* boundary = nullptr;
};

// Distances are exact at the samples, which are uniform by area. The mesh must be valid. Throws
// DataError when the mesh has no boundary with an area, SettingError, Cancelled.
BoundaryFit boundaryFit(const CellMesh& mesh, const Solid& solid,
                        const BoundaryFitSettings& settings = {});

// Whether a trilinear hexahedron is right side out everywhere, not at its corners alone.
//
// Its Jacobian determinant is a polynomial of degree 2 in each of the three coordinates. Of its 27
// Bernstein coefficients over the unit cube those at the corners are values, and all together bound
// it: all positive proves that it is so everywhere. Where that is undecided the cube is halved
// along each axis and each part looked at. After Johnen, Weill and Remacle, "Robust and efficient
// validation of the linear hexahedral element" (IMR 2017).
//
// Rounding is counted: each coefficient has a margin that a forward error analysis gives, and at
// corners whose sign that leaves open it is found by exact arithmetic (Shewchuk 1997). What stays
// within the margin is undecided.

struct JacobianBounds {
  double lower = 0, upper = 0;  // the least determinant over the cell lies between them: proven
  bool proven() const { return lower > 0; }     // right side out everywhere
  bool inverted() const { return upper <= 0; }  // somewhere not
};

// Of the map from the unit cube: 1 for a unit cube, in world units cubed. Ends as soon as the sign
// is decided, or after `halvings` in [0, 10].
JacobianBounds leastJacobian(const Points& vertices, const Hexahedron& cell, int halvings = 5);

struct HexahedronCheck {
  std::size_t inverted = 0;         // determinant not positive somewhere
  std::size_t invertedCorners = 0;  // of these, at a corner
  std::size_t undecided = 0;        // neither proven positive nor found to be inverted
  std::uint64_t exact = 0;          // corners whose sign took exact arithmetic
  bool proven() const { return inverted == 0 && undecided == 0; }
};

struct HexahedronCheckSettings {
  int halvings = 5;  // in [0, 10]
};

// Of all hexahedra of the mesh. Throws SettingError, Cancelled.
HexahedronCheck checkHexahedra(const CellMesh& mesh, const HexahedronCheckSettings& settings = {});

// Sets of equal cubes of a lattice: what a polycube is made of.

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

// A solid as a few equal cubes: of its topology, and as near to it as so many cubes can be.
//
// Blocks are filled by the share of them that lies inside of the solid, for several shifts of the
// lattice and several thresholds, and made manifold; of those sets that have the solid's topology
// each is bettered block by block without changing that (simple blocks, after Bertrand and
// Malandain, "A new characterization of three-dimensional simple points", 1994), and the nearest to
// the solid is taken. Where there is none the set is grown from its fullest block.

struct PolycubeSettings {
  // 0: or a few more, where so many have not the mesh's topology.
  int blocks = 0;
};

std::vector<Setting> describe(PolycubeSettings& settings);

// A part of the solid that no block covers.
struct MissedPart {
  Vec3 centre;        // world units
  double volume = 0;  // share of the solid's
};

struct Polycube {
  BlockSet blocks;
  int across = 0;   // blocks along the longest side, as asked for or chosen
  int handles = 0;  // of the outer boundary
  int cavities = 0;
  double missed = 0;   // share of the solid's volume that is in no block
  double surplus = 0;  // volume of the blocks out of the solid, as a share of the solid's
  std::vector<MissedPart> missedParts;       // over 1e-3 of the volume each, largest first
  std::vector<std::string> notes, warnings;  // a line each
  StageSeconds seconds;                      // "solid", "blocks"
};

// The mesh must be closed (but for holes to be closed) and bound one body, which may have handles
// and cavities. Throws DataError
// for others, and when no set of so many blocks has the mesh's topology (then it names a number
// that does, where one up to 64 is found); SettingError, MemoryError, Cancelled. Deterministic.
Polycube makePolycube(const Mesh& mesh, const PolycubeSettings& settings = {});

constexpr int kMostAcross = 64;

// About how many blocks there will be in all, from the mesh's volume.
double expectedBlocks(const Mesh& mesh, int across);

// Bytes that it takes, at most, beside the mesh and its solid.
std::uint64_t polycubeMemory(const Mesh& mesh, const PolycubeSettings& settings = {});

struct HexahedralizeSettings {
  PolycubeSettings polycube;
  int pieces = 2;
  double featureAngle = 30;
  std::uint64_t seed = 1;
};

std::vector<Setting> describe(HexahedralizeSettings& settings);

struct Hexahedralization {
  CellMesh mesh;      // hexahedra of the blocks first, in their order, then those of the layer
  CellMesh inBlocks;  // the same hexahedra where they are in the polycube
  Polycube polycube;
  int pieces = 0;
  MapQuality boundaryMap;  // of the polycube's surface onto the solid's
  HexahedronCheck before;  // as carried
  HexahedronCheck after;
  CellQuality quality;                       // of mesh
  CellProof proof;                           // likewise
  BoundaryFit boundary;                      // fractions of the solid's diagonal
  double featureLength = 0;                  // of the solid's sharp edges, world units
  SurfaceDistance fromFeatures;              // of those from the hexahedra's surface
  std::vector<std::string> notes, warnings;  // a line each
  StageSeconds seconds;
};

// If some hexahedra stay inverted and the settings give no number of blocks, tries more blocks;
// `after` and a warning tell what is left. Throws as makePolycube() and
// correspondMeshes(); SettingError, MemoryError (before anything is done), Cancelled.
// Deterministic for a seed, whatever the number of threads.
Hexahedralization hexahedralize(const Mesh& mesh, const HexahedralizeSettings& settings = {});

// Peak need in bytes, about.
std::uint64_t hexahedralizeMemory(const Mesh& mesh, const HexahedralizeSettings& settings = {});

}  // namespace innermap
