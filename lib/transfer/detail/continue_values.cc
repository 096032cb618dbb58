#include "transfer/detail/continue_values.h"

#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/Morphology.h>

#include <cstdint>
#include <type_traits>
#include <vector>

#include "evaluate/topology.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr int kNeighbours = 27;  // and the voxel itself

openvdb::Coord neighbour(const openvdb::Coord& ijk, int n) {
  return ijk.offsetBy(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
}

struct NewVoxel {
  openvdb::Coord at;
  std::uint32_t active = 0;  // bit n: its neighbour n is
};
using Layer = std::vector<NewVoxel>;

using MaskReader = openvdb::tree::ValueAccessor<const openvdb::MaskTree, false>;

std::uint32_t activeAround(const MaskReader& at, const openvdb::Coord& ijk) {
  std::uint32_t bits = 0;
  for (int n = 0; n < kNeighbours; ++n)
    if (at.isValueOn(neighbour(ijk, n))) bits |= std::uint32_t{1} << n;
  return bits;
}

// The voxels around those of `front` that are not active; keep: of a voxel.
template <class Keep>
Layer layerAround(const openvdb::MaskTree& front, const openvdb::MaskTree& active,
                  const Keep& keep) {
  openvdb::MaskTree ring(front);
  openvdb::tools::dilateActiveValues(ring, 1, openvdb::tools::NN_FACE_EDGE_VERTEX,
                                     openvdb::tools::PRESERVE_TILES);
  ring.topologyDifference(active);
  Layer layer;
  for (auto leaf = ring.cbeginLeaf(); leaf; ++leaf)
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel)
      if (keep(voxel.getCoord())) layer.push_back({voxel.getCoord(), 0});
  parallelBlocks(layer.size(), 1024, [&](std::size_t begin, std::size_t end) {
    const MaskReader at(active);
    for (std::size_t i = begin; i < end; ++i) layer[i].active = activeAround(at, layer[i].at);
  });
  return layer;
}

// Layer by layer, the voxels around the active ones that are not inside the solid.
std::vector<Layer> layersAround(const openvdb::GridBase& grid, const openvdb::FloatGrid& solid,
                                int layers) {
  const auto access = solid.getConstAccessor();  // the sampler keeps a pointer to it
  const openvdb::tools::GridSampler<openvdb::FloatGrid::ConstAccessor, openvdb::tools::BoxSampler>
      distance(access, solid.transform());
  const double within = grid.voxelSize()[0];
  openvdb::MaskTree active = activeTopology(grid);
  std::vector<Layer> out(static_cast<std::size_t>(layers));
  for (Layer& layer : out) {
    layer = layerAround(active, active, [&](const openvdb::Coord& ijk) {
      return distance.wsSample(grid.transform().indexToWorld(ijk)) > -within;
    });
    for (const NewVoxel& voxel : layer) active.setValueOn(voxel.at);
  }
  return out;
}

template <class Value>
constexpr bool kHasMean = std::is_floating_point_v<typename openvdb::VecTraits<Value>::ElementType>;

// The mean of the active neighbours.
template <class Accessor, class Value = typename Accessor::ValueType>
Value meanAround(const Accessor& tree, const NewVoxel& voxel) {
  using Sum = std::conditional_t<openvdb::VecTraits<Value>::IsVec, openvdb::Vec3d, double>;
  Sum sum = openvdb::zeroVal<Sum>();
  int count = 0;
  for (int n = 0; n < kNeighbours; ++n) {
    if (!(voxel.active >> n & 1)) continue;
    sum += Sum(tree.getValue(neighbour(voxel.at, n)));
    ++count;
  }
  if constexpr (std::is_same_v<Value, Sum>)
    return sum * (1.0 / count);
  else
    return Value(sum / count);
}

template <class Tree>
std::vector<typename Tree::ValueType> valuesFor(const Tree& tree, const Layer& layer) {
  using Value = typename Tree::ValueType;
  std::vector<Value> values(layer.size());
  if constexpr (kHasMean<Value>) {
    parallelBlocks(layer.size(), 1024, [&](std::size_t begin, std::size_t end) {
      const openvdb::tree::ValueAccessor<const Tree, false> at(tree);
      for (std::size_t i = begin; i < end; ++i) values[i] = meanAround(at, layer[i]);
    });
  } else {
    for (std::size_t i = 0; i < layer.size(); ++i) {
      int first = 0;
      while (!(layer[i].active >> first & 1)) ++first;
      values[i] = tree.getValue(neighbour(layer[i].at, first));
    }
  }
  return values;
}

template <class Tree>
void fill(Tree& tree, const std::vector<Layer>& layers) {
  for (const Layer& layer : layers) {
    const std::vector<typename Tree::ValueType> values = valuesFor(tree, layer);
    for (std::size_t i = 0; i < layer.size(); ++i) tree.setValueOn(layer[i].at, values[i]);
  }
}

}  // namespace

openvdb::GridBase::Ptr continuedBeyond(const openvdb::GridBase& grid,
                                       const openvdb::FloatGrid& solid, int layers) {
  const openvdb::GridBase::Ptr out = grid.deepCopyGrid();
  const std::vector<Layer> around = layersAround(grid, solid, layers);
  out->apply<GridTypes::Remove<openvdb::MaskGrid>>(
      [&](auto& typed) { fill(typed.tree(), around); });
  return out;
}

void continueBySpeed(openvdb::Vec3SGrid& velocity, double seconds) {
  // A voxel and its part of a leaf, which may hold few.
  constexpr std::uint64_t kBytes = 100;
  const double voxel = velocity.voxelSize()[0];
  openvdb::MaskTree active = activeTopology(velocity);
  openvdb::MaskTree inner(active), front;
  openvdb::tools::erodeActiveValues(inner, 1, openvdb::tools::NN_FACE_EDGE_VERTEX,
                                    openvdb::tools::PRESERVE_TILES);
  for (auto v = velocity.cbeginValueOn(); v; ++v)
    if (static_cast<double>(v->length()) * seconds > 0 && !inner.isValueOn(v.getCoord()))
      front.setValueOn(v.getCoord());
  for (double reach = voxel; !front.empty(); reach += voxel) {
    requireMemory("continuing the velocity", processMemory(kBytes * 4 * front.activeVoxelCount()),
                  "give a shorter --shutter or a lower resolution");
    const Layer layer = layerAround(front, active, [](const openvdb::Coord&) { return true; });
    const std::vector<openvdb::Vec3s> values = valuesFor(velocity.tree(), layer);
    front.clear();
    for (std::size_t i = 0; i < layer.size(); ++i) {
      velocity.tree().setValueOn(layer[i].at, values[i]);
      active.setValueOn(layer[i].at);
      if (static_cast<double>(values[i].length()) * seconds > reach) front.setValueOn(layer[i].at);
    }
  }
}

}  // namespace innermap
