// Grids of all types behind one interface: sampled at sites, transformed by
// what they are, written on the voxels of a region.
#pragma once

#include <openvdb/openvdb.h>

#include <memory>
#include <optional>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/transfer/carry.h"

namespace innermap {

// Samplers reach over two voxels at most, and the boundary error over about one more.
constexpr int kContinuedLayers = 3;
// In folds the determinant passes through 0; a voxel there is filled from no less of the source
// than this, or one voxel would hold the mass of all.
constexpr double kLeastDeterminant = 1e-2;

// Where a voxel's value comes from, and the derivative of where things go with respect to where
// they were.
struct Site {
  Vec3 at;      // world units of the input
  Vec3 inside;  // for attributes of a solid: that place, or where it is far outside the surface
  Mat3 derivative;
};

// One input, or the parts of one tensor.
class Carrier {
 public:
  virtual ~Carrier() = default;

  // Empty grids like the inputs, active in the region.
  virtual openvdb::GridPtrVec makeOutput(const openvdb::MaskGrid& region) const = 0;

  // For the active voxels of the region's leaf at `origin`, in order. to: level set of the solid
  // that the output lives in, on its lattice. One thread a leaf.
  virtual void carry(const openvdb::Coord& origin, const Site* sites, const openvdb::FloatGrid& to,
                     const openvdb::GridPtrVec& output) const = 0;

  // The output as it should be written: level sets with true distances again.
  virtual void finish(openvdb::GridPtrVec&) const {}

  // Values that are positions, to be moved by the map once they are sampled; null for others.
  virtual openvdb::GridBase* positions(const openvdb::GridPtrVec&) const { return nullptr; }

  virtual bool isDensity() const { return false; }

  // Place of each output among the grids given.
  const std::vector<std::size_t>& places() const { return places_; }

 protected:
  explicit Carrier(std::vector<std::size_t> places) : places_(std::move(places)) {}

 private:
  std::vector<std::size_t> places_;
};

// Carriers for all of `grids`. solid: level set of the solid that they live in, null when it is not
// known: beyond it attributes (all but level sets, fog volumes and densities) are continued by a
// few voxels from their nearest, so that sampling along its surface does not meet the background.
// Must outlive them.
// Throws as requireCarriable().
std::vector<std::unique_ptr<Carrier>> makeCarriers(const openvdb::GridPtrVec& grids,
                                                   const CarrySettings& settings,
                                                   const openvdb::FloatGrid* solid);

// In grid_carrier.cc: one grid. densityLimit: CarrySettings::densityLimit of a density; none: it is
// no density. solid: as above.
std::unique_ptr<Carrier> makeGridCarrier(const openvdb::GridBase::Ptr& grid, std::size_t place,
                                         Sampling sampling, std::optional<double> densityLimit,
                                         const openvdb::FloatGrid* solid);

// In tensor_carrier.cc: six float grids or the three rows.
std::unique_ptr<Carrier> makeTensorCarrier(const openvdb::GridPtrVec& parts,
                                           std::vector<std::size_t> places, bool stress,
                                           Sampling sampling, const openvdb::FloatGrid* solid);

}  // namespace innermap
