// What is known of a mesh of cells, and how it is carried.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/fit/mapped_solid.h"
#include "innermap/lattice/cell_mesh.h"

namespace innermap {

// How well shaped the cells of a mesh are.

struct DihedralRange {
  double least = 0, greatest = 180;  // degrees
};

// Of the six angles between faces: 70.53 for all in a regular tetrahedron; 0 and 180 where the cell
// has no volume or is inverted.
DihedralRange dihedralRange(const Points& vertices, const Tetrahedron& cell);

// The least determinant of three unit edges at the eight corners and of the unit principal axes at
// the centre, in [-1, 1]: 1 for a box, not above 0 where a corner is inverted or flat. As Verdict
// (Stimpson et al., "The Verdict Library Reference Manual", 2007) and VTK compute it.
double scaledJacobian(const Points& vertices, const Hexahedron& cell);

// Of one kind of cell and one measure. All 0 where there are no cells.
struct QualitySummary {
  double least = 0, onePercent = 0, mean = 0, greatest = 0;  // 1% of the cells are below onePercent
  double lower = 0, binWidth = 0;                            // of the histogram
  std::vector<std::uint64_t> histogram;                      // cells a bin
};

struct CellQuality {
  std::vector<float> leastDihedral, greatestDihedral;  // degrees, #T
  std::vector<float> scaledJacobian;                   // #H
  std::uint64_t invertedTetrahedra = 0;                // not right side out, by exact signs
  std::uint64_t invertedHexahedra = 0;                 // likewise at a corner
  QualitySummary dihedral;                             // of leastDihedral; bins of 5 degrees
  double greatestAngle = 0;                            // of greatestDihedral
  QualitySummary jacobian;                             // of scaledJacobian; bins of 0.1 from -1
};

// The mesh must be valid. The same for any number of threads. Throws Cancelled.
CellQuality cellQuality(const CellMesh& mesh);

// Makes it fields of the mesh's cells, in place of those of an earlier quality: "least_dihedral"
// and "greatest_dihedral" where there are tetrahedra, "scaled_jacobian" where there are hexahedra;
// 0 for cells of the other kind. quality: of this mesh.
void setQualityFields(CellMesh& mesh, const CellQuality& quality);

// What is proven of a mesh's cells, with their vertices as they are. Files of cells (cell_file.h)
// hold vertices as these doubles, whatever their format, so it is proven of the cells as written.

struct CellProof {
  enum class Overlap {
    none,    // no two cells have an inside point in common
    some,    // two have
    unknown  // neither is shown
  };
  std::size_t cells = 0;
  std::size_t inverted = 0;   // not right side out everywhere, or flat
  std::size_t undecided = 0;  // right side out or not: within the margin of rounding
  Overlap overlap = Overlap::unknown;
  std::size_t meetings = 0;        // places where the boundary crosses or touches itself, or may
  std::uint64_t exact = 0;         // signs that took exact arithmetic; others were beyond rounding
  std::vector<Triangle> boundary;  // boundaryTriangles(), where it was asked whether they overlap

  bool rightSideOut() const { return cells > 0 && inverted + undecided == 0; }
  bool oneToOne() const { return rightSideOut() && overlap == Overlap::none; }
};

// Tetrahedra by the exact sign of their volume, hexahedra by leastJacobian() (hexahedralize.h).
// Where all are right side out and are tetrahedra that meet in whole faces, also whether they
// overlap, by exact signs: there as many cells lie about a point as their boundary winds about it,
// and this is looked at as a whole (Lipman, "Bijective Mappings of Meshes with Boundary and the
// Degree in Mesh Processing", SIAM J. Imaging Sciences 7(2), 2014). Cells with curved faces are not
// asked whether they overlap. The mesh must be valid. The same for any number of threads. Throws
// Cancelled.
CellProof proveCells(const CellMesh& mesh);

// "Proven of the 12 cells as written: none is inverted, and no two overlap." and the like: never
// more than is proven.
std::string statementOf(const CellProof& proof);

// Of a mesh and the places that its vertices came from: whether the map between the two that is
// linear on the cells is one-to-one. Empty where a cell is a hexahedron, or not right side out.
std::string linearMapStatement(const CellProof& from, const CellProof& to);

// A mesh of cells that fills one solid of a map, carried to the other: vertices inside by the map,
// those of the boundary by where they are on the surface.

struct CarryCellsSettings {
  // Farthest that a vertex of the boundary may be from the solid's surface, fraction of its
  // diagonal, in (0, 1]: a mesh that fills something else is refused.
  double farthest = 0.05;
};

struct CellCarry {
  CarriedCells cells;  // places on the surface: of targetSurface(mapped), back of sourceSurface
  std::size_t boundaryVertices = 0;
  double boundaryRms = 0, boundaryMax = 0;  // their distance from the solid, world units of it
  std::size_t readdressed = 0;              // nearer to a sheet that they turn their back on
};

// The surfaces that boundaries are carried onto: the same triangles, in the source and where the
// map's boundary takes them.
Mesh sourceSurface(const MappedSolid& mapped);
Mesh targetSurface(const MappedSolid& mapped);

// A vertex of the boundary takes the closest point of the source's surface; where that faces the
// other way than the boundary there (narrow gaps), the closest that is reached along the surface
// from its neighbours'. So the boundary goes exactly onto the target, which the map meets but for
// its boundary error. Deterministic. Throws DataError for a mesh without cells, or whose boundary
// is not the solid's (its vertices counted, with the farthest), SettingError, Cancelled.
CellCarry carryCells(const CellMesh& mesh, const MappedSolid& mapped,
                     const CarryCellsSettings& settings = {});

// A mesh of the source with where it is carried, free of inverted cells: a piecewise linear map.
struct CellMap {
  const CellMesh* mesh = nullptr;   // of tetrahedra
  const Points* carried = nullptr;  // #V
};

// The mesh fills the target; vertices inside are found in the map's tetrahedra. Throws as above.
CellCarry carryCellsBack(const CellMesh& mesh, const MappedSolid& mapped, const CellMap& map,
                         const CarryCellsSettings& settings = {});

}  // namespace innermap
