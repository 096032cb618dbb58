// evaluateMap() in two steps: values of voxels, which blocks of a volume can be given one by one,
// and what needs all of them.
#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "evaluate/field_region.h"
#include "innermap/evaluate/evaluate_map.h"

namespace innermap {

// What some voxels add to the totals.
struct MapTotals {
  double harmonic = 0, deformation = 0, volume = 0, folded = 0;
  double rounding = 0;
  double jacobianMin = std::numeric_limits<double>::infinity(), jacobianMax = -jacobianMin;
  std::uint64_t active = 0, interior = 0, foldedVoxels = 0;

  void add(const MapTotals& t);

  static constexpr std::size_t kNumbers = 10;
  std::array<double, kNumbers> numbers() const;
  static MapTotals of(const double* numbers);  // kNumbers
};

struct BlockTotals {
  openvdb::Coord block;  // blockOf() its voxels
  MapTotals totals;
};

struct MapValues {
  MapGrids grids;                   // map, Jacobian and energies; no totals
  std::vector<BlockTotals> blocks;  // each once
  // Of each leaf, by its origin; empty where the values were made elsewhere.
  std::vector<std::pair<openvdb::Coord, MapTotals>> leaves;
};

// Map, Jacobian and energies, those of them that are wanted, with the value 0 on the region.
MapGrids mapGridsOn(const openvdb::MaskGrid& region, const EvaluateSettings& wanted);

// The voxels that values are wanted for. Throws SettingError, MemoryError, Cancelled.
openvdb::MaskGrid::Ptr mapRegion(const openvdb::FloatGrid& levelSet,
                                 const EvaluateSettings& settings);

// region: of mapRegion() with these settings. Throws SettingError, Cancelled.
MapValues mapValues(const ComposedMap& map, const FieldRegion& region,
                    const EvaluateSettings& settings);

// levelSet: of the solid, or makeLevelSetBlock(). The same values for each block, whichever others
// the level set has. Settings and errors as evaluateMap().
MapValues mapValues(const ComposedMap& map, const Solid& solid, const openvdb::FloatGrid& levelSet,
                    const EvaluateSettings& settings);

// values: of all blocks, with the level set of all. Repairs folds and sums totals, in an order that
// does not depend on who made which block.
MapGrids concludeValues(const ComposedMap& map, const Solid& solid,
                        const openvdb::FloatGrid& levelSet, const EvaluateSettings& settings,
                        MapValues values);

// Both, in a region that is made once for several maps.
MapGrids evaluateMap(const ComposedMap& map, const FieldRegion& region,
                     const EvaluateSettings& settings);

}  // namespace innermap
