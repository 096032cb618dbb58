// A mesh of cells that fills one solid of a map, carried to the other: vertices inside by the map,
// those of the boundary by where they are on the surface.
#pragma once

#include <cstddef>

#include "innermap/boundary/mapped_solid.h"
#include "innermap/lattice/cell_mesh.h"
#include "innermap/tetra/cell_locator.h"

namespace innermap {

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
