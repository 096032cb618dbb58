#include "io/volume/detail/volume_builder.h"

#include <openvdb/tools/Prune.h>

#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <type_traits>

#include "evaluate/topology.h"
#include "innermap/core/run.h"
#include "io/volume/detail/volume_sampler.h"

namespace innermap {
namespace {

constexpr int kLeaf = 8, kLeafVoxels = 512;

template <class Element>
Element elementOf(double pixel) {
  if constexpr (std::is_same_v<Element, bool>) {
    return pixel >= 0.5;
  } else if constexpr (std::is_integral_v<Element>) {
    // The type's ends are no floats: what rounds beyond them is them.
    constexpr auto kLeast = std::numeric_limits<Element>::min();
    constexpr auto kMost = std::numeric_limits<Element>::max();
    if (std::isnan(pixel)) return 0;
    if (pixel >= static_cast<double>(kMost)) return kMost;
    if (pixel <= static_cast<double>(kLeast)) return kLeast;
    return static_cast<Element>(std::llround(pixel));
  } else {
    return static_cast<Element>(pixel);
  }
}

template <class Grid>
class TypedBuilder : public VolumeBuilder {
 public:
  using Tree = typename Grid::TreeType;
  using Leaf = typename Tree::LeafNodeType;
  using Value = typename Grid::ValueType;
  using Element = typename openvdb::VecTraits<Value>::ElementType;
  static constexpr bool kMask = std::is_same_v<Grid, openvdb::MaskGrid>;
  static constexpr bool kVector = openvdb::VecTraits<Value>::IsVec;
  static constexpr int kComponents = kVector ? 3 : 1;

  TypedBuilder(const VolumeGrid& about, const VolumeLattice& lattice, bool halfPixels)
      : lattice_(lattice) {
    for (int c = 0; c < kComponents; ++c) pixel_[c] = pixelValue(about.background[c], halfPixels);
    if constexpr (kMask) {
      grid_ = Grid::create();
    } else {
      background_ = exactBackground(about.background);
      grid_ = Grid::create(background_);
    }
    grid_->setName(about.name);
    grid_->setGridClass(openvdb::GridBase::stringToGridClass(about.gridClass));
    if constexpr (kVector)
      grid_->setVectorType(openvdb::GridBase::stringToVecType(about.vectorType));
    grid_->setTransform(openvdb::math::Transform::createLinearTransform(lattice.indexToWorld));
    levelSet_ = std::is_floating_point_v<Value> && grid_->getGridClass() == openvdb::GRID_LEVEL_SET;
  }

  std::size_t add(const VolumeSlab& slab) override {
    const std::vector<openvdb::Coord> origins = leafOrigins(slab);
    std::vector<Block> blocks(origins.size());
    std::atomic<std::size_t> notFinite{0};
    parallelBlocks(origins.size(), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) notFinite += makeBlock(slab, origins[i], blocks[i]);
    });
    for (std::size_t i = 0; i < origins.size(); ++i) insert(origins[i], blocks[i]);
    return notFinite;
  }

  std::uint64_t memory() const override { return leaves_ * leafBytes(); }
  std::uint64_t leafBytes() const override {
    return sizeof(Leaf) + (kMask ? 0 : kLeafVoxels * sizeof(Value));
  }

  openvdb::GridBase::Ptr finish() override {
    if constexpr (std::is_floating_point_v<Value>)
      if (levelSet_) openvdb::tools::pruneLevelSet(grid_->tree());
    return grid_;
  }

 private:
  // What 8^3 voxels are: the background, a uniform tile, or a leaf.
  struct Block {
    std::unique_ptr<Leaf> leaf;
    Value tile = openvdb::zeroVal<Value>();
    bool tileActive = false, empty = true;
  };

  static Value exactBackground(const openvdb::Vec3d& b) {
    if constexpr (kVector)
      return Value(elementOf<Element>(b[0]), elementOf<Element>(b[1]), elementOf<Element>(b[2]));
    else
      return elementOf<Element>(b[0]);
  }

  std::vector<openvdb::Coord> leafOrigins(const VolumeSlab& slab) const {
    openvdb::CoordBBox box = lattice_.box();
    box.min()[lattice_.axis] += slab.first;
    box.max()[lattice_.axis] = box.min()[lattice_.axis] + slab.count - 1;
    std::vector<openvdb::Coord> origins;
    const openvdb::Coord from = box.min() & ~(kLeaf - 1);
    for (int x = from.x(); x <= box.max().x(); x += kLeaf)
      for (int y = from.y(); y <= box.max().y(); y += kLeaf)
        for (int z = from.z(); z <= box.max().z(); z += kLeaf) origins.emplace_back(x, y, z);
    return origins;
  }

  bool isBackground(const std::array<float, 3>& pixel) const {
    if (levelSet_) return std::abs(pixel[0]) == std::abs(pixel_[0]);
    for (int c = 0; c < kComponents; ++c)
      if (!(pixel[c] == pixel_[c])) return false;
    return true;
  }

  // Where voxel `at` stands in the slab's channels; outside the box, nothing.
  std::ptrdiff_t placeOf(const VolumeSlab& slab, const openvdb::Coord& at) const {
    const openvdb::Coord c = at - lattice_.origin;
    const int slice = c[lattice_.axis] - slab.first, column = c[lattice_.columnAxis];
    int row = c[lattice_.rowAxis];
    if (slice < 0 || slice >= slab.count || column < 0 || column >= lattice_.width() || row < 0 ||
        row >= lattice_.height())
      return -1;
    if (lattice_.rowsUp) row = lattice_.height() - 1 - row;
    return (std::ptrdiff_t(slice) * lattice_.height() + row) * lattice_.width() + column;
  }

  // The voxel's value; whether it is active.
  bool voxel(const VolumeSlab& slab, std::ptrdiff_t place, Value& value, bool& finite) const {
    std::array<float, 3> pixel{0, 0, 0};
    for (int c = 0; c < kComponents; ++c) {
      pixel[c] = slab.channels[static_cast<std::size_t>(c)][place];
      finite = finite && std::isfinite(pixel[c]);
    }
    const bool hasActive = slab.channels.size() > static_cast<std::size_t>(kComponents);
    bool on = hasActive ? slab.channels.back()[place] >= 0.5f : !isBackground(pixel);
    if constexpr (kMask) {
      on = pixel[0] >= 0.5f;
      value = on;
    } else {
      if constexpr (kVector)
        value = Value(elementOf<Element>(pixel[0]), elementOf<Element>(pixel[1]),
                      elementOf<Element>(pixel[2]));
      else
        value = elementOf<Element>(pixel[0]);
      if (!on) value = inactiveValue(pixel[0]);
    }
    return on;
  }

  Value inactiveValue(float pixel) const {
    if constexpr (std::is_floating_point_v<Value>)
      if (levelSet_ && pixel < 0) return -background_;
    return background_;
  }

  std::size_t makeBlock(const VolumeSlab& slab, const openvdb::Coord& origin, Block& block) const {
    std::array<Value, kLeafVoxels> values;
    std::array<bool, kLeafVoxels> active;
    std::size_t notFinite = 0;
    bool uniform = true;
    for (int i = 0; i < kLeafVoxels; ++i) {
      const openvdb::Coord at = origin.offsetBy(i >> 6, i >> 3 & 7, i & 7);
      const std::ptrdiff_t place = placeOf(slab, at);
      values[i] = background_;
      active[i] = false;
      bool finite = true;
      if (place >= 0) active[i] = voxel(slab, place, values[i], finite);
      notFinite += !finite;
      uniform = uniform && active[i] == active[0] && values[i] == values[0];
    }
    block.empty = uniform && !active[0] && values[0] == background_;
    if (block.empty) return notFinite;
    block.tile = values[0];
    block.tileActive = active[0];
    if (uniform) return notFinite;
    block.leaf = std::make_unique<Leaf>(origin, background_, false);
    for (int i = 0; i < kLeafVoxels; ++i) {
      const auto offset = static_cast<openvdb::Index>(i);
      if constexpr (!kMask) block.leaf->setValueOnly(offset, values[i]);
      block.leaf->setActiveState(offset, active[i]);
    }
    return notFinite;
  }

  void insert(const openvdb::Coord& origin, Block& block) {
    if (block.empty) return;
    // Slabs end where leaves do, so no leaf comes twice.
    if (block.leaf) {
      grid_->tree().addLeaf(block.leaf.release());
      ++leaves_;
    } else {
      grid_->tree().addTile(1, origin, block.tile, block.tileActive);
    }
  }

  VolumeLattice lattice_;
  typename Grid::Ptr grid_;
  Value background_ = openvdb::zeroVal<Value>();
  std::array<float, 3> pixel_{0, 0, 0};  // the background as pixels hold it
  bool levelSet_ = false;
  std::uint64_t leaves_ = 0;
};

// Calls body with an empty pointer of the grid's type; false when there is none of that name.
template <class Body>
bool withVolumeType(const std::string& type, const Body& body) {
  bool found = false;
  GridTypes::foreach ([&](const auto& value) {
    using Grid = std::decay_t<decltype(value)>;
    // OpenVDB calls a mask's values bool too.
    constexpr bool kMask = std::is_same_v<Grid, openvdb::MaskGrid>;
    if ((kMask ? "mask" : Grid().valueType()) != type) return;
    found = true;
    body(static_cast<const Grid*>(nullptr));
  });
  return found;
}

}  // namespace

bool isVolumeType(const std::string& type) {
  return withVolumeType(type, [](auto) {});
}

bool isVectorType(const std::string& type) {
  return type == "vec3s" || type == "vec3d" || type == "vec3i";
}

std::unique_ptr<VolumeBuilder> makeVolumeBuilder(const VolumeGrid& grid,
                                                 const VolumeLattice& lattice, bool halfPixels) {
  std::unique_ptr<VolumeBuilder> builder;
  withVolumeType(grid.type, [&](auto pointer) {
    using Grid = std::remove_const_t<std::remove_pointer_t<decltype(pointer)>>;
    builder = std::make_unique<TypedBuilder<Grid>>(grid, lattice, halfPixels);
  });
  return builder;
}

}  // namespace innermap
