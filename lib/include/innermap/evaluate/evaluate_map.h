// A harmonic map on the grid of its solid: positions, Jacobian determinants, energies, totals.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/core/vec3.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/levelset/solid.h"

namespace innermap {

// Energy densities of a map from its Jacobian, after Li et al., "Meshless Harmonic Volumetric
// Mapping Using Fundamental Solution Methods" (IEEE T-ASE 2009), formulas (3) and (4).

// Elastic constants; the defaults are the paper's (rubber). lambda >= 0, mu >= 0.
struct LameConstants {
  double lambda = 0.0335;
  double mu = 0.0224;
};

std::vector<Setting> describe(LameConstants& settings);

// ||J||^2, the squared Frobenius norm: 3 for the identity and every rotation.
double harmonicEnergyDensity(const Mat3& jacobian);

// psi = 1/2 s : e with strain e = J^T J - I (no factor 1/2) and stress s = lambda tr(e) I + 2 mu e.
// 0 for every rigid motion, reflections included; (s^2 - 1)^2 (9/2 lambda + 3 mu) for uniform
// scaling by s.
double deformationEnergyDensity(const Mat3& jacobian, const LameConstants& lame = {});

struct EvaluateSettings {
  bool map = true, jacobian = true, harmonicEnergy = true, deformationEnergy = true;
  LameConstants lame;
  double targetVolume = 0;  // world units cubed; scales the harmonic energy; 0: as the source's
  // Folds are repaired where at most this share of the voxels inside is folded, in [0, 1]: about
  // each the map is replaced by one that is linear between voxels and folds nowhere, if one is
  // found; see MapGrids::repaired. 0: never.
  double repairUpTo = 0;
  // World units of the target. MapGrids::map holds positions less this, and folds are looked for in
  // it: floats hold little of positions that are far from the origin.
  Vec3 origin;
  bool mirrored = false;  // onto a target that is inside out: det J < 0 where nothing is folded
  double skin = 2;        // active voxels outside the surface, in [0, 3]
  // Of the sums of charges: root mean square error of positions as a fraction of the target's
  // extent, in [1e-12, 1e-3]. The default is what float grids hold.
  double accuracy = 1e-7;
};

// Value grids have the level set's transform; active where the signed distance is at most the skin.
// Voxels outside the solid hold the extension from their closest boundary point c: f(c) + J(c)
// (p - c) for `map`, the value at c for the others (the field itself is singular at the sources
// just outside). Background 0.
struct MapGrids {
  openvdb::Vec3fGrid::Ptr map;                // target position of each voxel less the origin of
                                              // the settings, world units
  openvdb::FloatGrid::Ptr jacobian;           // det of the map's gradient
  openvdb::FloatGrid::Ptr harmonicEnergy;     // density, both solids scaled to unit volume
  openvdb::FloatGrid::Ptr deformationEnergy;  // density psi
  // How far each voxel was moved to repair folds, world units of the target; null if none was. The
  // Jacobian of such a voxel is the mean of the tetrahedra about it.
  openvdb::FloatGrid::Ptr repaired;
  // Active, and 1, at the voxels inside where the map's own determinant, before repair, is not
  // above 0 (of a mirrored map: not below). Null if there are none, or if the settings ask for no
  // Jacobian.
  openvdb::FloatGrid::Ptr folded;

  // Integrals over the solid; cells along the surface count by their share inside.
  double harmonicTotal = 0;     // both solids scaled to unit volume: 3 for a rigid motion
  double deformationTotal = 0;  // world units cubed times the density's unit
  double volume = 0;            // of the cells: the solid's, as the grid sees it
  double jacobianMin = 0, jacobianMax = 0;  // over voxels whose centre is inside
  double foldedFraction = 0;                // share of the volume that is folded
  std::uint64_t activeVoxels = 0, interiorVoxels = 0;
  std::uint64_t foldedVoxels = 0;      // whose centre is inside; before repair
  std::uint64_t foldedVoxelsLeft = 0;  // after it
  double repairedFarthest = 0;         // greatest value of `repaired`
  // Farthest that rounding to floats moves a position of an active voxel, the origin not taken off;
  // world units of the target.
  double rounding = 0;

  std::vector<openvdb::GridBase::Ptr> all() const;  // those that were asked for
};

// Diagonal of the box of the boundary's image, at some hundred points, world units; 1 where that is
// 0. The unit of EvaluateSettings::accuracy.
double targetExtent(const ComposedMap& map, const Solid& solid);

// levelSet: of the same solid, half-width at least the skin. Throws SettingError, MemoryError,
// Cancelled. Deterministic for any number of threads.
MapGrids evaluateMap(const ComposedMap& map, const Solid& solid, const openvdb::FloatGrid& levelSet,
                     const EvaluateSettings& settings = {});

}  // namespace innermap
