// A map given voxel by voxel.
#pragma once

#include <openvdb/openvdb.h>

#include <functional>

#include "evaluate/detail/cell_check.h"
#include "fit/test_pairs.h"

namespace innermap::test {

// Voxels that are inside, and where they go.
class Lattice {
 public:
  explicit Lattice(double voxel = 1) {
    levelSet->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
  }

  void addBox(const openvdb::Coord& lower, const openvdb::Coord& upper,
              const std::function<Vec3(const Vec3&)>& to) {
    auto distances = levelSet->getAccessor();
    auto positions = map->getAccessor();
    for (const openvdb::Coord& c : openvdb::CoordBBox(lower, upper)) {
      const Vec3 q = to({double(c.x()), double(c.y()), double(c.z())});
      distances.setValue(c, -1);
      positions.setValue(c, openvdb::Vec3f(openvdb::Vec3d(q.x, q.y, q.z)));
    }
  }

  CellFigures check() const {
    static const Mesh mesh = ball(1);
    return checkCells(*map, *levelSet, TargetShape(makeBoundaryPair(mesh, mesh)), 0);
  }

  openvdb::FloatGrid::Ptr levelSet = openvdb::FloatGrid::create(1);
  openvdb::Vec3fGrid::Ptr map = openvdb::Vec3fGrid::create();
};

}  // namespace innermap::test
