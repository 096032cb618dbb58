// `--through`: a repaired mesh in place of the map that it was carried by.
#pragma once

#include <string>

#include "context.h"
#include "innermap/boundary/mapped_solid.h"
#include "innermap/tetra/linear_map.h"
#include "innermap/transfer/carry_points.h"
#include "innermap/transfer/through_map.h"

namespace innermap::tool {

// Throws DataError for a mesh that lies elsewhere than the map's solids.
LinearCellMap readThrough(const std::string& path, const MappedSolid& mapped, Context& context);

ThroughMap throughMap(const LinearCellMap& map);

// Points farther from the mesh than settings.outside and the skin say are cut.
PointCarry carryThrough(const LinearCellMap& map, bool push, const CarryPointsSettings& settings);

}  // namespace innermap::tool
