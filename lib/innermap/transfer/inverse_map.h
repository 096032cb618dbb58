// The inverse of a map on the voxels of its target: where each of them comes from.
#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "innermap/field/harmonic_map.h"
#include "innermap/levelset/solid.h"
#include "innermap/transfer/outside.h"

namespace innermap {

struct InverseSettings {
  OutsideSettings outside;
  double skin = 2;          // voxels outside the target's surface, in [0, 3]
  double tolerance = 1e-3;  // of f(p) = q, target voxels, in [1e-6, 0.01]
  double accuracy = 1e-7;   // of the sums of charges, as EvaluateSettings::accuracy
};

// Throws SettingError for a number out of its range.
void requireInRange(const InverseSettings& settings);

struct InverseStatistics {
  std::uint64_t voxels = 0;     // of the region
  std::uint64_t inverted = 0;   // with a residual of at most 0.01 voxel
  std::uint64_t uncovered = 0;  // in no cell's image: folds, and gaps along the boundary
  std::uint64_t failed = 0;     // not inverted
  std::uint64_t inside = 0, failedInside = 0;  // of those with their centre inside the target
  double largestResidual = 0;                  // of those inverted, target voxels
  Box3 failedBox;                              // world units of the target
  Points failedAt;                             // the first of them, at most 16

  double invertedInside() const;  // share of the voxels inside; 1 when there are none
  double invertedOutside() const;
  // What to warn of when over 0.5% of the voxels inside are not inverted, else nothing.
  std::string warning() const;
};

// For the voxels of `region` in the order of its leaves and of the voxels in them; voxels of leaf l
// start at first[l].
struct InvertedMap {
  openvdb::MaskGrid::Ptr region;
  std::vector<std::size_t> first;               // #leaves + 1
  Points sources;                               // #voxels: p with f(p) = q, world units
  std::vector<std::array<float, 9>> jacobians;  // #voxels: of f at p, row by row
  InverseStatistics statistics;
};

// A lattice of voxels through a solid, and as far around it as the map is to be used.
struct SourceLattice {
  openvdb::FloatGrid::Ptr levelSet;  // of the solid
  openvdb::MaskGrid::Ptr region;
};

// For each voxel of the target (those of targetLevelSet whose distance is at most the skin; with
// settings.outside also those around it that come from the lattice) the point p with f(p) = q:
// cells of the lattice are mapped, voxels in their images start with second-order accuracy, and
// Newton steps with the analytic Jacobian do the rest, halved while they do not help. Voxels inside
// that these do not invert start again from the sources of their neighbours, and, where the map has
// steps, from what inverting these one after the other finds. A voxel that is not inverted has the
// source and Jacobian of the nearest one that is. Outside the solid the map is extended as
// transfer/outside.h says, so voxels along the boundary, which the map meets but for its boundary
// error, have sources just outside. Same result for any number of threads. Throws SettingError,
// DataError (nothing of the target is inverted), MemoryError, Cancelled.
InvertedMap invertMap(const ComposedMap& map, const Solid& source, const SourceLattice& lattice,
                      const openvdb::FloatGrid& targetLevelSet,
                      const InverseSettings& settings = {});

// The same at any points of the target, world units; points that are in no voxel of `inverted` stay
// as they are. #points.
Points invertAt(const ComposedMap& map, const Solid& source, const SourceLattice& lattice,
                const InvertedMap& inverted, const Points& targets,
                const InverseSettings& settings = {});

}  // namespace innermap
