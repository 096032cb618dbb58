#include "innermap/evaluate/active_region.h"

#include <openvdb/tools/LevelSetUtil.h>

#include <cmath>
#include <string>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"

namespace innermap {

openvdb::MaskGrid::Ptr activeRegion(const openvdb::FloatGrid& levelSet,
                                    const RegionSettings& settings) {
  const double skin = settings.skin;
  const double voxel = levelSet.voxelSize()[0];
  if (!(skin >= 0) || skin * voxel > levelSet.background() * (1 + 1e-6))
    throw SettingError("skin", "of " + std::to_string(skin) +
                                   " voxels is wider than the level set's band; widen the band");
  // sdfInteriorMask takes values below the isovalue; the skin's edge itself belongs to it.
  const auto iso = static_cast<float>(std::nextafter(skin * voxel, INFINITY));
  const openvdb::BoolGrid::Ptr inside = openvdb::tools::sdfInteriorMask(
      levelSet, std::min(iso, std::nextafter(levelSet.background(), 0.f)));
  throwIfCancelled(settings.progress);
  const std::uint64_t leafVoxels = openvdb::FloatTree::LeafNodeType::SIZE;
  std::uint64_t leaves = inside->tree().leafCount();
  for (auto tile = inside->cbeginValueOn(); tile; ++tile)
    if (tile.isTileValue()) leaves += tile.getVoxelCount() / leafVoxels;
  requireMemory("evaluating " + std::to_string(leaves) + " blocks of 8^3 voxels",
                leaves * leafVoxels * settings.bytesPerVoxel, settings.maxMemory,
                "use a larger --voxel-size or a lower --resolution (memory grows with its cube)");
  auto region = openvdb::MaskGrid::create();
  region->setTransform(levelSet.transform().copy());
  region->tree().topologyUnion(inside->tree());
  region->tree().voxelizeActiveTiles();
  return region;
}

}  // namespace innermap
