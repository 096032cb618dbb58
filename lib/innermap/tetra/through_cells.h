// A carried and repaired mesh (remesh_cells.h) in place of the map that it was carried by: what
// goes through it agrees with the mesh and is nowhere folded.
#pragma once

#include "innermap/boundary/mapped_solid.h"
#include "innermap/tetra/linear_map.h"
#include "innermap/transfer/carry_points.h"
#include "innermap/transfer/through_map.h"

namespace innermap {

// Of a mesh that remeshCells() made with the map. Throws as LinearCellMap; DataError for a mesh
// that lies elsewhere than the map's target (their boxes differ by over a tenth of the diagonal).
LinearCellMap linearMapOf(const CellMesh& carried, const MappedSolid& mapped);

// For PushSettings::through and PullSettings::through.
ThroughMap throughMap(const LinearCellMap& map);

// Points, from the source (push) or to it. Those farther from the mesh than settings.outside and
// the skin say are cut.
PointCarry carryThrough(const LinearCellMap& map, bool push, const CarryPointsSettings& settings);

}  // namespace innermap
