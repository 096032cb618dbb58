// A map on its solid and beyond: harmonic inside, extended from the closest
// boundary point outside, faded to a rigid motion where that is asked for. A pointwise map says
// itself what it does there.
#pragma once

#include <openvdb/openvdb.h>

#include <string_view>
#include <vector>

#include "evaluate/extended_places.h"
#include "evaluate/visit_field.h"
#include "innermap/levelset/solid.h"
#include "innermap/transfer/carry.h"
#include "innermap/transfer/inverse_map.h"

namespace innermap {

// Holds references. Thread-safe.
class ExtendedMap {
 public:
  // accuracy: of the sums, world units of the target.
  ExtendedMap(const SolidMap& map, const Solid& solid, const openvdb::FloatGrid& levelSet,
              const OutsideSettings& outside, double accuracy)
      : map_(map), solid_(solid), levelSet_(levelSet), outside_(outside), accuracy_(accuracy) {}

  std::vector<PointImage> at(const Points& points) const;
  // places: of the points, by placeExtended.
  std::vector<PointImage> at(const Points& points, const ExtendedPlaces& places) const;

  // Images of points that are inside the solid.
  Points imagesInside(const Points& points) const;

  // The same at lattice voxels; sample i of `samples` is that of the i-th active voxel of a leaf.
  using Visitor = std::function<void(std::size_t leaf, const LeafValues& values,
                                     const std::vector<PointImage>& samples)>;
  void visit(const openvdb::MaskGrid& region, const Visitor& visit, std::string_view stage) const;

  const ComposedMap& harmonic() const { return *map_.harmonic(); }
  const Solid& solid() const { return solid_; }
  const openvdb::FloatGrid& levelSet() const { return levelSet_; }
  double accuracy() const { return accuracy_; }
  // World units; how far outside the map is meant to be used.
  double reach() const { return outside_.distance * solid_.diagonal(); }
  bool endless() const { return outside_.fadeTo.has_value(); }

 private:
  // Surely beyond the reach, where only the rigid motion is left.
  bool isRigidAt(const Vec3& p) const;
  void visitPointwise(const openvdb::MaskGrid& region, const Visitor& visit,
                      std::string_view stage) const;
  void fade(const Vec3& p, const Vec3& beyond, PointImage& sample) const;

  const SolidMap map_;  // by value: often made of one harmonic map for the call
  const Solid& solid_;
  const openvdb::FloatGrid& levelSet_;
  const OutsideSettings& outside_;
  double accuracy_;
};

}  // namespace innermap
