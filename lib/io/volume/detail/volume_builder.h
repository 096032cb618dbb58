// Grids from dense slabs of pixels.
#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "io/volume/detail/volume_attributes.h"
#include "io/volume/detail/volume_lattice.h"

namespace innermap {

// Slices of the lattice that lie in one layer of leaves.
struct VolumeSlab {
  int first = 0, count = 0;
  // Of one grid's channels, the active one last if it has one: count * height * width floats each.
  std::vector<const float*> channels;
};

class VolumeBuilder {
 public:
  virtual ~VolumeBuilder() = default;

  // Slabs in order, each once. Returns the number of values that are not finite.
  virtual std::size_t add(const VolumeSlab& slab) = 0;
  virtual std::uint64_t memory() const = 0;     // of what was built, bytes
  virtual std::uint64_t leafBytes() const = 0;  // of a leaf
  virtual openvdb::GridBase::Ptr finish() = 0;
};

// Whether a grid of that type can be built: float, double, int32, int64, bool, mask, vec3s, vec3d,
// vec3i.
bool isVolumeType(const std::string& type);
bool isVectorType(const std::string& type);

// halfPixels: the channels are half floats, and so is the background in them. `grid` is of a type
// that can be built and has as many channels as that has components.
std::unique_ptr<VolumeBuilder> makeVolumeBuilder(const VolumeGrid& grid,
                                                 const VolumeLattice& lattice, bool halfPixels);

}  // namespace innermap
