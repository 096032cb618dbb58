// Values of grids on the lattice of a volume texture, as its pixels hold them.
#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>
#include <memory>

#include "io/volume/detail/volume_lattice.h"

namespace innermap {

// What happened to values on their way into pixels.
struct PixelCounts {
  std::size_t clamped = 0;  // beyond the pixel type's largest number
  std::size_t inexact = 0;  // whole numbers that the pixel type does not have
};

// What values are rounded to. number: none, a double holds them.
enum class PixelType { half, single, number };

// The float that a pixel holds for a value: a half float's, or single precision's; clamped to the
// largest one, NaN and infinities as they are.
float pixelValue(double value, bool asHalf);

// Where the lattice's voxels are in the grid: `index = scale * latticeIndex + offset`.
struct VolumeResampling {
  bool copies = true;  // the lattice is the grid's own
  double scale = 1;    // grid voxels along a lattice voxel
  openvdb::Vec3d offset{0, 0, 0};
};

// Reads one grid. Safe from any number of threads.
class VolumeSampler {
 public:
  virtual ~VolumeSampler() = default;

  // One row of one slice: lattice.width() values to each of outputs[0 ... components), and, when
  // `active` is not null, 1 or 0 to that.
  virtual PixelCounts row(const VolumeLattice& lattice, int slice, int row, double* const* outputs,
                          double* active) const = 0;
};

// Values of float, double and vector grids are interpolated linearly; the mean over as many points
// a side as grid voxels lie in a lattice voxel, but for level sets, which are distances at points.
// Whole numbers, truth values and masks are the nearest voxel's. Throws DataError for types that
// have no numbers.
std::unique_ptr<VolumeSampler> makeVolumeSampler(const openvdb::GridBase& grid,
                                                 const VolumeResampling& resampling,
                                                 PixelType pixel);

}  // namespace innermap
