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

#include <cstdint>
#include <string>
#include <vector>

#include "innermap/field/harmonic_field.h"
#include "innermap/levelset/level_set.h"
#include "innermap/levelset/solid.h"
#include "innermap/transfer/outside.h"

namespace innermap {

// As OpenVDB's samplers have them. Grids of whole numbers and of truth values are always sampled
// at the nearest voxel.
enum class Sampling { nearest, linear, quadratic };

struct CarrySettings {
  Sampling sampling = Sampling::linear;
  bool allDensities = false;  // all float and double grids but level sets and parts of tensors
  std::vector<std::string> densities;  // or those of these names
  // Symmetric tensors by their common name: six float grids NAME.xx, .yy, .zz, .xy, .yz, .xz, or
  // three Vec3 grids NAME.x, .y, .z, the rows.
  std::vector<std::string> stresses, strains;
};

// The least edge of a voxel of the grids, world units: what the output has unless told otherwise.
double finestVoxel(const openvdb::GridPtrVec& grids);

// Estimate of the peak need, in bytes, of pushing or pulling the grids to the voxels of a solid,
// those of makeLevelSet(solid, output). Only the distance of `outside` counts; of `carry`, which
// grids are densities.
std::uint64_t carryMemory(const Solid& solid, const openvdb::GridPtrVec& grids,
                          const LevelSetSettings& output, const OutsideSettings& outside = {},
                          const CarrySettings& carry = {});

// A harmonic field on the source that is written on the target's voxels: at q its value at p.
struct CarriedField {
  std::string name;
  HarmonicField field;  // one channel: a float grid, three: Vec3f
  openvdb::VecType vectorType = openvdb::VEC_INVARIANT;
};

}  // namespace innermap
