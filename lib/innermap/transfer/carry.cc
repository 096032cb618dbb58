#include "innermap/transfer/carry.h"

#include <algorithm>

namespace innermap {

double finestVoxel(const openvdb::GridPtrVec& grids) {
  double finest = 0;
  for (const openvdb::GridBase::Ptr& grid : grids) {
    const openvdb::Vec3d size = grid->voxelSize();
    const double smallest = std::min({size.x(), size.y(), size.z()});
    if (finest == 0 || smallest < finest) finest = smallest;
  }
  return finest;
}

}  // namespace innermap
