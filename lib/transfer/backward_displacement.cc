// The displacement from a map's target back to its source, on voxels.
#include <utility>

#include "innermap/transfer/inverse_map.h"
#include "transfer/detail/source_lattice.h"

namespace innermap {

BackwardDisplacement backwardDisplacement(const SolidMap& map, const Solid& source,
                                          const openvdb::FloatGrid& targetLevelSet,
                                          const InverseSettings& settings) {
  using openvdb::Vec3STree;
  const SourceLattice lattice = makeSourceLattice(source, settings.outside, {});
  InvertedMap inverted = invertMap(map, source, lattice, targetLevelSet, settings);
  const auto tree = std::make_shared<Vec3STree>(inverted.region->tree(), openvdb::Vec3s(0),
                                                openvdb::TopologyCopy());
  BackwardDisplacement out;
  out.grid = openvdb::Vec3SGrid::create(tree);
  out.grid->setName("displacement");
  out.grid->setTransform(targetLevelSet.transform().copy());
  out.grid->setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
  openvdb::tree::LeafManager<Vec3STree> leaves(*tree);
  leaves.foreach ([&](Vec3STree::LeafNodeType& leaf, std::size_t l) {
    std::size_t voxel = inverted.first[l];
    for (auto value = leaf.beginValueOn(); value; ++value) {
      const openvdb::Vec3d place = targetLevelSet.indexToWorld(value.getCoord());
      const Vec3& from = inverted.sources[voxel++];
      value.setValue(openvdb::Vec3s(openvdb::Vec3d(from.x, from.y, from.z) - place));
    }
  });
  out.statistics = std::move(inverted.statistics);
  return out;
}

}  // namespace innermap
