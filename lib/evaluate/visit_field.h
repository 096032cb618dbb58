// A harmonic field at the voxels of its solid and of a skin about it, leaf by leaf: what every grid
// of a field is made from.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "evaluate/extended_places.h"
#include "evaluate/field_region.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/levelset/solid.h"

namespace innermap {

// The block of 128 voxels along each side that a voxel lies in: its origin. Leaves are summed with
// others of their block only, so that what a leaf gets does not depend on which blocks are visited.
inline openvdb::Coord blockOf(const openvdb::Coord& voxel) {
  return voxel &
         ~(static_cast<int>(openvdb::MaskTree::RootNodeType::ChildNodeType::ChildNodeType::DIM) -
           1);
}

// The active voxels of one leaf. Outside the solid the field is not evaluated (it is singular at
// the sources there) but extended from the closest boundary point c: the value is f(c) + J(c) (p -
// c), the gradient J(c).
struct LeafValues {
  openvdb::Coord origin;                  // of the leaf, index space
  std::size_t count = 0, channels = 0;    // voxels, K
  const std::uint16_t* offset = nullptr;  // place in the leaf
  const double* share = nullptr;          // of the voxel's cell that lies inside the solid, 0..1
  const Vec3* beyond = nullptr;           // p - c in world units; zero inside
  const std::uint8_t* inside = nullptr;   // 1 where the voxel's centre is inside
  const double* values = nullptr;         // K for each voxel
  const double* gradients = nullptr;      // 3 K for each voxel: 3 k + axis; or null
};

// `leaf` counts the leaves of the region in their tree's order. Called from many threads, once for
// each leaf.
using LeafVisitor = std::function<void(std::size_t leaf, const LeafValues& values)>;

struct VisitSettings {
  double accuracy = 0;  // of the sums: root mean square error, units of the values, above 0
  std::string_view stage = "evaluating";
  bool gradients = true;  // without them LeafValues::gradients is null
};

// Throws SettingError, Cancelled. The same values for any number of threads.
void visitField(const HarmonicField& field, const FieldRegion& region, const LeafVisitor& visit,
                const VisitSettings& settings);

// The same of a map: three channels. The first of its steps is summed on the lattice, the others at
// points.
void visitField(const ComposedMap& map, const FieldRegion& region, const LeafVisitor& visit,
                const VisitSettings& settings);

// The same at any points, world units: values #points x K, gradients #points x 3 K. beyond: as
// above, #points. levelSet only tells which points are near the surface.
struct ExtendedSamples {
  FieldSamples samples;
  Points beyond;
};
ExtendedSamples sampleExtended(const HarmonicField& field, const Solid& solid,
                               const openvdb::FloatGrid& levelSet, const Points& points,
                               const VisitSettings& settings);
ExtendedSamples sampleExtended(const ComposedMap& map, const Solid& solid,
                               const openvdb::FloatGrid& levelSet, const Points& points,
                               const VisitSettings& settings);

// The same at points whose places are known.
FieldSamples sampleExtended(const ComposedMap& map, const ExtendedPlaces& places,
                            const VisitSettings& settings);

}  // namespace innermap
