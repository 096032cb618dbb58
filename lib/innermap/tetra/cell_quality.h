// How well shaped the cells of a mesh are.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "innermap/lattice/cell_mesh.h"

namespace innermap {

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
  std::uint64_t invertedTetrahedra = 0;                // signedVolume() not above 0
  std::uint64_t invertedHexahedra = 0;                 // a corner's not above 0
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

}  // namespace innermap
