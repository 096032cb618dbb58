#include "evaluate/detail/proof_marks.h"

#include "innermap/core/run.h"

namespace innermap {
namespace {

// Voxels whose centre is in the cell. The level set's voxels are cubes along the axes.
openvdb::CoordBBox voxelsOf(const ProofCell& cell, const openvdb::FloatGrid& levelSet) {
  const openvdb::Vec3d center(cell.center.x, cell.center.y, cell.center.z);
  const openvdb::Vec3d lower = levelSet.worldToIndex(center - openvdb::Vec3d(cell.halfEdge)),
                       upper = levelSet.worldToIndex(center + openvdb::Vec3d(cell.halfEdge));
  return {openvdb::Coord::ceil(lower), openvdb::Coord::floor(upper)};
}

}  // namespace

openvdb::FloatGrid::Ptr markCells(const std::vector<ProofCell>& cells,
                                  const openvdb::FloatGrid& levelSet, const char* name,
                                  openvdb::FloatGrid::Ptr marks) {
  if (!marks) {
    marks = openvdb::FloatGrid::create();
    marks->setTransform(levelSet.transform().copy());
    marks->setName(name);
  }
  auto voxels = marks->getAccessor();
  const auto distance = levelSet.getConstAccessor();
  const openvdb::CoordBBox solid = levelSet.evalActiveVoxelBoundingBox();
  for (const ProofCell& cell : cells) {
    throwIfCancelled();
    openvdb::CoordBBox box = voxelsOf(cell, levelSet);
    box.intersect(solid);
    if (box.empty()) continue;  // between the voxels' centres; its iterator does not end
    for (auto at = box.beginXYZ(); at; ++at)
      if (distance.getValue(*at) < 0) voxels.setValue(*at, 1);
  }
  return marks->empty() ? nullptr : marks;
}

}  // namespace innermap
