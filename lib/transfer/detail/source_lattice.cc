#include "transfer/detail/source_lattice.h"

#include <openvdb/tools/Morphology.h>

#include <algorithm>
#include <cmath>

#include "core/require_number.h"
#include "evaluate/active_region.h"
#include "evaluate/topology.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/levelset/level_set.h"

namespace innermap {
namespace {

constexpr int kAcross = 128;         // voxels along the longest side of the solid
constexpr int kFewest = 32;          // when much around it has to be covered too
constexpr double kMostVoxels = 2e6;  // voxels of the lattice, about; starts need not be good
constexpr double kSkin = 2;          // voxels
constexpr std::uint64_t kVoxelBytes = 12 + 4 + 1;

Box3 worldBox(const openvdb::CoordBBox& box, const openvdb::math::Transform& transform) {
  Box3 out;
  for (int corner = 0; corner < 8; ++corner) {
    const openvdb::Vec3d p = transform.indexToWorld(
        openvdb::Vec3d(corner & 1 ? box.max().x() + 0.5 : box.min().x() - 0.5,
                       corner & 2 ? box.max().y() + 0.5 : box.min().y() - 0.5,
                       corner & 4 ? box.max().z() + 0.5 : box.min().z() - 0.5));
    out.add(Vec3{p.x(), p.y(), p.z()});
  }
  return out;
}

openvdb::CoordBBox onLattice(const openvdb::CoordBBox& box, const openvdb::math::Transform& from,
                             const openvdb::math::Transform& to) {
  openvdb::CoordBBox out;
  for (int corner = 0; corner < 8; ++corner) {
    const openvdb::Vec3d ijk(corner & 1 ? box.max().x() + 0.5 : box.min().x() - 0.5,
                             corner & 2 ? box.max().y() + 0.5 : box.min().y() - 0.5,
                             corner & 4 ? box.max().z() + 0.5 : box.min().z() - 0.5);
    const openvdb::Vec3d at = to.worldToIndex(from.indexToWorld(ijk));
    for (int a = 0; a < 3; ++a)
      if (!(std::abs(at[a]) < 1e6))
        throw DataError(
            "volume: reaches farther from the solid than a million "
            "of its voxels; cut it off");
    out.expand(openvdb::Coord::floor(at));
    out.expand(openvdb::Coord::ceil(at));
  }
  return out;
}

// Lattice voxels about the grids' active ones, by whole blocks; at most `most` of them.
openvdb::MaskTree around(const openvdb::GridPtrVec& grids, const openvdb::math::Transform& lattice,
                         std::uint64_t most) {
  openvdb::MaskTree mask;
  for (const openvdb::GridBase::Ptr& grid : grids) {
    const openvdb::MaskTree active = activeTopology(*grid);
    const auto add = [&](const openvdb::CoordBBox& box) {
      throwIfCancelled();
      mask.fill(onLattice(box, grid->transform(), lattice), true, true);
      if (mask.leafCount() * 512 > most)
        throw MemoryError(
            "outside: the volume around the solid takes too many "
            "voxels; lower --outside, cut the "
            "volume off or raise --max-memory");
    };
    for (auto leaf = active.cbeginLeaf(); leaf; ++leaf) {
      openvdb::CoordBBox box;
      leaf->evalActiveBoundingBox(box, false);
      if (!box.empty()) add(leaf->getNodeBoundingBox());
    }
    for (auto tile = active.cbeginValueOn(); tile; ++tile) {
      if (tile.isVoxelValue()) continue;
      openvdb::CoordBBox box;
      tile.getBoundingBox(box);
      add(box);
    }
  }
  return mask;
}

// World units cubed that the grids' active voxels span: by whole blocks of 8^3, or by their box
// where tiles span much with few blocks.
double extentOf(const openvdb::GridPtrVec& grids) {
  double volume = 0;
  Box3 box;
  bool tiles = false;
  for (const openvdb::GridBase::Ptr& grid : grids) {
    const openvdb::Vec3d v = grid->voxelSize();
    volume += static_cast<double>(grid->baseTree().leafCount()) * 512 * v.x() * v.y() * v.z();
    box.add(worldBox(grid->evalActiveVoxelBoundingBox(), grid->transform()));
    tiles = tiles || grid->baseTree().activeTileCount() > 0;
  }
  const Vec3 extent = box.extent();
  return tiles ? extent.x * extent.y * extent.z : volume;
}

// As fine as the grids, within bounds.
int latticeResolution(const Solid& solid, const OutsideSettings& outside,
                      const openvdb::GridPtrVec& grids) {
  const Vec3 extent = solid.box().extent();
  const double longest = std::max({extent.x, extent.y, extent.z});
  double finest = longest / kAcross;
  if (!grids.empty()) finest = grids.front()->voxelSize()[0];
  for (const openvdb::GridBase::Ptr& grid : grids)
    for (int a = 0; a < 3; ++a) finest = std::min(finest, grid->voxelSize()[a]);
  int most = kAcross;
  if (outside.distance > 0) {
    const double margin = 2 * outside.distance * solid.diagonal();
    double volume = extentOf(grids);
    if (!outside.fadeTo)
      volume = std::min(volume, (extent.x + margin) * (extent.y + margin) * (extent.z + margin));
    most = static_cast<int>(longest / std::cbrt(volume / kMostVoxels));
  }
  return std::clamp(static_cast<int>(std::min<double>(longest / finest, most)), kFewest, kAcross);
}

}  // namespace

void addAround(openvdb::MaskGrid& region, const Solid& solid, double distance,
               std::uint64_t bytesPerVoxel) {
  const openvdb::MaskTree inner = region.tree();
  const int layers = static_cast<int>(std::ceil(distance / region.voxelSize()[0]));
  openvdb::CoordBBox box = region.evalActiveVoxelBoundingBox();
  box.expand(layers);
  requireMemory("the space around the solid", box.volume() * bytesPerVoxel,
                "use larger voxels or a smaller --outside");
  openvdb::tools::dilateActiveValues(region.tree(), layers, openvdb::tools::NN_FACE_EDGE_VERTEX,
                                     openvdb::tools::EXPAND_TILES);
  region.tree().voxelizeActiveTiles();
  std::vector<openvdb::MaskTree::LeafNodeType*> leaves;
  region.tree().getNodes(leaves);
  parallelBlocks(
      leaves.size(), 8,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l)
          for (auto voxel = leaves[l]->beginValueOn(); voxel; ++voxel) {
            if (inner.isValueOn(voxel.getCoord())) continue;
            const openvdb::Vec3d p = region.indexToWorld(voxel.getCoord());
            if (solid.closest({p.x(), p.y(), p.z()}, distance).onSurface.triangle < 0)
              leaves[l]->setValueOff(voxel.pos());
          }
      },
      "finding the surroundings");
}

SourceLattice makeSourceLattice(const Solid& solid, const OutsideSettings& outside,
                                const openvdb::GridPtrVec& grids) {
  requireNumber("outside", outside.distance, {0, 1}, "of the diagonal");
  SourceLattice out;
  LevelSetSettings settings;
  settings.resolution = latticeResolution(solid, outside, grids);
  out.levelSet = makeLevelSet(solid, settings);
  RegionSettings inside;
  inside.skin = kSkin;
  inside.bytesPerVoxel = kVoxelBytes;
  out.region = activeRegion(*out.levelSet, inside);
  if (!(outside.distance > 0)) return out;
  const double voxel = out.levelSet->voxelSize()[0];
  const std::uint64_t most = memoryLimit() / kVoxelBytes;
  openvdb::MaskTree more = around(grids, out.levelSet->transform(), most);
  if (!outside.fadeTo) {
    const int layers = static_cast<int>(std::ceil(outside.distance * solid.diagonal() / voxel)) + 1;
    openvdb::MaskTree within = out.region->tree();
    openvdb::tools::dilateActiveValues(within, layers, openvdb::tools::NN_FACE_EDGE_VERTEX,
                                       openvdb::tools::EXPAND_TILES);
    more.topologyIntersection(within);
  }
  more.voxelizeActiveTiles();
  out.region->tree().topologyUnion(more);
  out.region->tree().voxelizeActiveTiles();
  return out;
}

}  // namespace innermap
