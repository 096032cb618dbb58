#include "innermap/transfer/detail/continue_values.h"

#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/Morphology.h>

#include <vector>

#include "innermap/core/parallel.h"

namespace innermap {
namespace {

// Voxels one layer around the active ones that are not inside the solid.
template <class Grid>
std::vector<openvdb::Coord> nextLayer(const Grid& grid, const openvdb::FloatGrid& solid) {
  openvdb::MaskTree ring;
  ring.topologyUnion(grid.tree());
  openvdb::tools::dilateActiveValues(ring, 1, openvdb::tools::NN_FACE_EDGE_VERTEX,
                                     openvdb::tools::PRESERVE_TILES);
  ring.topologyDifference(grid.tree());
  const auto access = solid.getConstAccessor();  // the sampler keeps a pointer to it
  const openvdb::tools::GridSampler<openvdb::FloatGrid::ConstAccessor, openvdb::tools::BoxSampler>
      distance(access, solid.transform());
  const double within = grid.voxelSize()[0];
  std::vector<openvdb::Coord> out;
  for (auto leaf = ring.cbeginLeaf(); leaf; ++leaf)
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel) {
      const openvdb::Coord ijk = voxel.getCoord();
      if (distance.wsSample(grid.transform().indexToWorld(ijk)) > -within) out.push_back(ijk);
    }
  return out;
}

template <class Value>
struct Mean {
  Value sum = openvdb::zeroVal<Value>();
  int count = 0;
  void add(const Value& value) {
    sum += value;
    ++count;
  }
  Value value() const { return sum * (1.0 / count); }
};

template <class Value>
struct First {
  Value first = openvdb::zeroVal<Value>();
  int count = 0;
  void add(const Value& value) {
    if (count++ == 0) first = value;
  }
  Value value() const { return first; }
};

template <>
struct Mean<std::int32_t> : First<std::int32_t> {};
template <>
struct Mean<std::int64_t> : First<std::int64_t> {};
template <>
struct Mean<bool> : First<bool> {};
template <>
struct Mean<openvdb::Vec3i> : First<openvdb::Vec3i> {};
template <>
struct Mean<float> {
  double sum = 0;
  int count = 0;
  void add(float value) {
    sum += value;
    ++count;
  }
  float value() const { return static_cast<float>(sum / count); }
};
template <>
struct Mean<openvdb::Vec3f> {
  openvdb::Vec3d sum{0, 0, 0};
  int count = 0;
  void add(const openvdb::Vec3f& value) {
    sum += value;
    ++count;
  }
  openvdb::Vec3f value() const { return openvdb::Vec3f(sum / count); }
};

}  // namespace

template <class Grid>
typename Grid::Ptr continuedBeyond(const Grid& grid, const openvdb::FloatGrid& solid, int layers) {
  typename Grid::Ptr out = grid.deepCopy();
  for (int layer = 0; layer < layers; ++layer) {
    const std::vector<openvdb::Coord> voxels = nextLayer(*out, solid);
    std::vector<typename Grid::ValueType> values(voxels.size());
    parallelBlocks(voxels.size(), 1024, [&](std::size_t begin, std::size_t end) {
      auto around = static_cast<const Grid&>(*out).getConstAccessor();
      for (std::size_t i = begin; i < end; ++i) {
        Mean<typename Grid::ValueType> mean;
        typename Grid::ValueType value;
        for (int n = 0; n < 27; ++n)
          if (around.probeValue(voxels[i].offsetBy(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1), value))
            mean.add(value);
        values[i] = mean.value();
      }
    });
    auto write = out->getAccessor();
    for (std::size_t i = 0; i < voxels.size(); ++i) write.setValueOn(voxels[i], values[i]);
  }
  return out;
}

#define INNERMAP_CONTINUED(Grid) \
  template Grid::Ptr continuedBeyond<Grid>(const Grid&, const openvdb::FloatGrid&, int)
INNERMAP_CONTINUED(openvdb::FloatGrid);
INNERMAP_CONTINUED(openvdb::DoubleGrid);
INNERMAP_CONTINUED(openvdb::Int32Grid);
INNERMAP_CONTINUED(openvdb::Int64Grid);
INNERMAP_CONTINUED(openvdb::BoolGrid);
INNERMAP_CONTINUED(openvdb::Vec3SGrid);
INNERMAP_CONTINUED(openvdb::Vec3DGrid);
INNERMAP_CONTINUED(openvdb::Vec3IGrid);
#undef INNERMAP_CONTINUED

}  // namespace innermap
