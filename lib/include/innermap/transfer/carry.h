// How the values of grids move with a map: what each grid is, and what it becomes.
//
// With A the derivative of where a point goes with respect to where it was:
//   scalar        s                       density      s / |det A|
//   vectors, by OpenVDB's vector type:
//     invariant   v                       covariant    A^-T v
//     covariant normalize   A^-T v / |A^-T v|
//     contravariant relative  A v         contravariant absolute: the position v itself is mapped
//   Cauchy stress S  A S A^T / |det A|    covariant strain E  A^-T E A^-1
// (Marsden and Hughes, "Mathematical Foundations of Elasticity", 1983, section 1.3.)
#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/core/vec3.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/levelset/level_set.h"
#include "innermap/levelset/solid.h"

namespace innermap {

// As OpenVDB's samplers have them. Grids of whole numbers and of truth values are always sampled
// at the nearest voxel.
enum class Sampling { nearest, linear, quadratic };

struct CarrySettings {
  Sampling sampling = Sampling::linear;
  bool allDensities = false;  // all float and double grids but level sets and parts of tensors
  std::vector<std::string> densities;  // or those of these names
  // No density grows more than so many times, above 0; what comes together beyond that is left out.
  double densityLimit = std::numeric_limits<double>::infinity();
  // Symmetric tensors by their common name: six float grids NAME.xx, .yy, .zz, .xy, .yz, .xz, or
  // three Vec3 grids NAME.x, .y, .z, the rows.
  std::vector<std::string> stresses, strains;
};

// Of the sampling and the limit on densities.
std::vector<Setting> describe(CarrySettings& settings);

// Whether the settings make a density of a grid: scalars of a float or double grid that fill space.
bool isDensity(const openvdb::GridBase& grid, const CarrySettings& settings);

// Throws DataError for grids that cannot be pushed or pulled: an unknown type, a name in the
// settings that no grid has, a tensor whose parts are missing or doubled.
void requireCarriable(const openvdb::GridPtrVec& grids, const CarrySettings& settings);

// The least edge of a voxel of the grids, world units: that of the output unless told otherwise,
// times voxelGrowth().
double finestVoxel(const openvdb::GridPtrVec& grids);

// By how much volumes grow from one to the other; 1 where one of them is not known (not above 0).
double volumeRatio(double from, double to);

// What the voxels of grids grow by, unless told otherwise, when they go from a solid of one volume
// to one of the other: the cube root of their ratio; 1 where that is within a tenth of it, so that
// poses keep the grids' own lattice.
double voxelGrowth(double from, double to);

// What became of a density, world units: sums of values times the voxel's volume.
struct CarriedMass {
  std::string name;
  // Of the voxels that are carried: those whose centre is in the solid (of fog volumes, whose
  // values at the surface are shares, those that touch it), with outside settings also those
  // around it. And of all active voxels of the target.
  double before = 0, after = 0;
  double left = 0;  // of all other active voxels of the source
  double cut = 0;   // that CarrySettings::densityLimit left out
  // The most volume of the source in any voxel of the target, by the volume of that: no density of
  // the target is larger than the source's largest times this.
  double largestRatio = 0;
  // The same of the tetrahedra by themselves: the volume of one by that of its image.
  double largestCompression = 0;
  std::uint64_t cells = 0, foldedCells = 0;  // of the source; turned inside out at least in part
};

// How much of what is carried is finer than the output's voxels: where these are more than
// kCoarser times as large as the finest of the input, moved by the map (the cube root of its
// determinant). Shares are of the input's solid, by volume.
constexpr double kCoarser = 1.5;
struct ResamplingFigures {
  double inputVoxel = 0, outputVoxel = 0;  // edges, world units
  double coarserShare = 0;
  double largestGrowth = 0;  // the most that any volume shrinks inside, so any density grows

  // growth: of the input's volumes, at a place of the output.
  void add(double growth);
  void add(const ResamplingFigures& others);
  void finish();

  double sum = 0, coarser = 0;  // volumes of the input while voxels are added
};

// Of CarriedField::shutter, where nothing else is said: frames, as renderers have it.
constexpr double kUsualShutter = 0.5;

// A harmonic field on the source that is written on the target's voxels: at q its value at p.
struct CarriedField {
  std::string name;
  HarmonicField field;  // one channel: a float grid, three: Vec3f
  openvdb::VecType vectorType = openvdb::VEC_INVARIANT;
  // Of velocities, seconds: the grid goes on around the target as far as its values go in this
  // time, so that what a renderer smears beyond the skin finds them there. 0: ends as others do.
  double shutter = 0;
};

// A map beyond its solid, for smoke around a body.
//
// Outside, the map is never evaluated (its charges stand there) but extended from the closest
// boundary point c: E(p) = f(c) + J(c) (p - c). Up to a stated distance it is that, faded to a
// rigid motion or cut off where it ends.

struct RigidMotion {
  Mat3 rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3 translation;  // p -> rotation p + translation, world units

  Vec3 operator()(const Vec3& p) const;
};

// Whether its matrix is a rotation, by entries within the tolerance (numbers are written with a few
// digits).
bool isRigid(const RigidMotion& motion, double tolerance = 1e-4);

// The rigid motion that moves `from` onto `to` best by least squares; same number of points, not
// all in one line. Horn, "Closed-form solution of absolute orientation using unit quaternions" (J.
// Opt. Soc. Am. A, 1987). Throws DataError when there are fewer than three pairs.
RigidMotion bestRigidMotion(const Points& from, const Points& to);

struct OutsideSettings {
  double distance = 0;  // fraction of the source's diagonal, in [0, 1]; 0: the solid alone
  // Where the extension fades to by `distance`, and what moves the rest of the grids beyond;
  // without one they are cut off there.
  std::optional<RigidMotion> fadeTo;
};

// Of OutsideSettings::distance.
inline Setting outsideSetting(double* distance) {
  return Setting("outside", "D", distance,
                 "also carry what lies around the solid, up to this distance")
      .in("fraction of the diagonal")
      .from(0, 1);
}

// What pushing and pulling grids need in memory.

// Which way, and how many fields of vectors are pushed beside (VolumePusher::push).
struct CarryKind {
  bool pushed = true;
  int fields = 0;
};

// Estimate of the need, in bytes, of pushing or pulling the grids, which are read already, to the
// voxels of a solid, those of makeLevelSet(solid, output). Only the distance of `outside` counts;
// of `carry`, which grids are densities.
std::uint64_t carryMemory(const Solid& solid, const openvdb::GridPtrVec& grids,
                          const LevelSetSettings& output, const OutsideSettings& outside = {},
                          const CarrySettings& carry = {}, const CarryKind& kind = {});

}  // namespace innermap
