// Boundary values continued harmonically into a solid, as grids that meet the values themselves at
// the surface.
//
// A field of N charges holds what is coarser than their spacing h. What it misses at the boundary,
// value less field, has wavelengths below 2 h, and the harmonic continuation of a wave of length L
// falls off as exp(-2 pi depth / L). So the rest is carried inwards from the closest boundary point
// with the factor exp(-pi depth / h), the depth counted from one voxel below the surface, as far as
// interpolation at the surface sees: exact there, a twentieth one spacing further in, and then the
// field alone.
#pragma once

#include <openvdb/openvdb.h>

#include <functional>
#include <vector>

#include "innermap/field/harmonic_field.h"
#include "innermap/levelset/solid.h"

namespace innermap {

// Writes the #K boundary values at a point of the surface. Called from many threads.
using BoundaryValues = std::function<void(const Solid::Closest& at, double* values)>;

struct ContinuationSettings {
  // World units: the spacing of the field's charges. 0: the field alone is taken, and outside the
  // solid its value at the closest boundary point.
  double spacing = 0;
  double skin = 2;         // active voxels outside the surface, in [0, 3]
  double accuracy = 1e-5;  // of sums: root mean square error, units of the values, positive
};

// A Vec3f grid (vector type invariant, background 0) for each three channels of the field, whose
// number must be a multiple of three. Active inside and in the skin; voxels outside have the
// boundary's value at their closest point. levelSet: of the same solid, half-width at least the
// skin. The same for any number of threads. Throws DataError, SettingError, MemoryError (before
// allocating), Cancelled.
std::vector<openvdb::Vec3fGrid::Ptr> continueInside(const HarmonicField& field, const Solid& solid,
                                                    const openvdb::FloatGrid& levelSet,
                                                    const BoundaryValues& boundary,
                                                    const ContinuationSettings& settings);

}  // namespace innermap
