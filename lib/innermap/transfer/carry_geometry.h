// Meshes, point clouds, curves and cells carried through a map.
#pragma once

#include <cstdint>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/transfer/carry_points.h"
#include "innermap/transfer/geometry.h"

namespace innermap {

struct CarryGeometrySettings {
  // Edges of faces and lines are split in the middle, again and again, until their straight images
  // are nowhere (at a quarter, a half, three quarters) farther than this from where the map brings
  // them: world units of what is carried to; 0 splits none. Not negative.
  double subdivide = 0;
};

// Of `subdivide`, as a share of the diagonal of the solid that is carried to.
Setting subdivideSetting(double* share);

struct CarriedGeometry {
  CarriedPoints points;            // of geometry.points, those of cells' values included
  std::vector<Points> directions;  // as geometry.directions
  std::uint64_t ownPoints = 0;     // those of the file that were there before edges were split
  std::uint64_t added = 0;         // on split edges
  std::uint64_t folded = 0;        // points where the map turns space inside out, where Jacobians
                                   // were taken
  std::uint64_t cutElements = 0;   // elements with a point that is cut
  // New numbers of the points that stay, -1 for others; and whether each element stays.
  std::vector<int> number;
  std::vector<std::uint8_t> stays;
};

// Splits edges of `geometry` where that is asked for, then carries it. Jacobians are taken where
// there are directions. Throws what `carry` throws; MemoryError when edges are split beyond the
// limit; SettingError.
CarriedGeometry carryGeometry(Geometry& geometry, const PointCarry& carry,
                              const CarryGeometrySettings& settings = {});

// Peak need in bytes, beside the geometry itself, without splitting.
std::uint64_t carryGeometryMemory(const Geometry& geometry);

}  // namespace innermap
