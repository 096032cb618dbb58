#include "levelset/detail/narrow_band.h"

#include <fmt/format.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "core/disjoint_sets.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/levelset/level_set.h"
#include "levelset/detail/band.h"

namespace innermap {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using Leaf = FloatGrid::TreeType::LeafNodeType;
using BlockNode = FloatGrid::TreeType::RootNodeType::ChildNodeType::ChildNodeType;

constexpr int kMinAcross = 4;
constexpr double kUsualHalfWidth = 3;  // voxels

// Rounded up: the band is as wide as asked in single precision too.
float backgroundOf(double width) {
  const float f = static_cast<float>(width);
  return f < width ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

// Signs of one leaf's voxels. Two neighbours have the same sign when the balls about them that are
// free of surface meet; one winding number settles each set of voxels so connected. Next to the
// surface it is often only a neighbour across an edge or a corner whose ball is large enough.
class LeafSigns {
 public:
  LeafSigns(const SolidBody& body, const Band& band, const Coord& leaf, double voxelSize,
            const double* distances)
      : distances_(distances), sets_(Band::kLeafVoxels) {
    // More than one voxel by a margin for rounding: faces often lie just between two voxels.
    for (int n = 1; n <= 3; ++n)
      reach_[n] = (1 + 1e-6) * std::sqrt(double(n)) * voxelSize + 2 * body.gap();
    for (int x = 0; x < 8; ++x) {
      for (int y = 0; y < 8; ++y) {
        for (int z = 0; z < 8; ++z) {
          const int i = x << 6 | y << 3 | z;
          if (x < 7) connect(i, i + 64, reach_[1]);
          if (y < 7) connect(i, i + 8, reach_[1]);
          if (z < 7) connect(i, i + 1, reach_[1]);
          if (2 * distances[i] <= reach_[1]) connectAcross(x, y, z);
        }
      }
    }
    // The farthest voxel of a set speaks for it.
    std::array<int, Band::kLeafVoxels> speaker;
    speaker.fill(-1);
    for (int i = 0; i < Band::kLeafVoxels; ++i) {
      int& s = speaker[sets_.find(i)];
      if (s < 0 || distances[i] > distances[s]) s = i;
    }
    for (int i = 0; i < Band::kLeafVoxels; ++i) {
      if (speaker[i] < 0) continue;
      const int s = speaker[i];
      inside_[i] = body.inside(band.position(leaf.offsetBy(s >> 6, s >> 3 & 7, s & 7)));
    }
  }

  bool inside(int i) { return inside_[sets_.find(i)]; }

 private:
  void connect(int i, int j, double reach) {
    if (distances_[i] + distances_[j] > reach) sets_.unite(i, j);
  }

  void connectAcross(int x, int y, int z) {
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dz = -1; dz <= 1; ++dz) {
          const int axes = dx * dx + dy * dy + dz * dz;
          if (axes < 2 || ((x + dx) | (y + dy) | (z + dz)) & ~7) continue;
          connect(x << 6 | y << 3 | z, (x + dx) << 6 | (y + dy) << 3 | (z + dz), reach_[axes]);
        }
      }
    }
  }

  const double* distances_;
  std::array<double, 4> reach_{};
  DisjointSets sets_;
  std::array<bool, Band::kLeafVoxels> inside_{};
};

// Null when no voxel is in the band.
std::unique_ptr<Leaf> makeLeaf(const SolidBody& body, const Band& band, const Coord& origin,
                               double voxelSize, float background) {
  std::array<double, Band::kLeafVoxels> distances;
  band.distances(origin, distances.data());
  // After rounding to float the value must still be within the background.
  const auto inBand = [&](double d) { return static_cast<float>(d) < background; };
  if (std::none_of(distances.begin(), distances.end(), inBand)) return nullptr;
  LeafSigns signs(body, band, origin, voxelSize, distances.data());
  auto leaf = std::make_unique<Leaf>(origin, background, false);
  for (int i = 0; i < Band::kLeafVoxels; ++i) {
    const bool active = inBand(distances[i]);
    const double d = active ? distances[i] : background;
    leaf->setValueOnly(static_cast<openvdb::Index>(i),
                       static_cast<float>(signs.inside(i) ? -d : d));
    leaf->setActiveState(static_cast<openvdb::Index>(i), active);
  }
  return leaf;
}

// Tiles of a block inside and outside as the flood fill of the whole has them, which looks no
// farther than the node where that has leaves.
void fillBlock(const SolidBody& body, const Band& band, const Coord& block,
               FloatGrid::TreeType& tree) {
  constexpr int kHalf = BlockNode::DIM / 2;
  const float outside = tree.background();
  if (auto* node = tree.probeNode<BlockNode>(block))
    openvdb::tools::SignedFloodFillOp<FloatGrid::TreeType>(outside, -outside, 1)(*node);
  else if (body.inside(band.position(block.offsetBy(kHalf))))
    tree.addTile(BlockNode::LEVEL + 1, block, -outside, false);
}

}  // namespace

double voxelSizeAcross(const Box3& box, int resolution) {
  const Vec3 e = box.extent();
  const double longest = std::max({e.x, e.y, e.z});
  if (longest / kMinAcross < kLeastVoxel) {
    throw DataError(fmt::format(
        "the solid is {:.4g} across, too small for OpenVDB, whose voxels cannot be under {:.4g}; "
        "scale the mesh up",
        longest, kLeastVoxel));
  }
  return std::max(longest / resolution, kLeastVoxel);
}

Vec3 latticeOrigin(const Box3& box, double voxelSize) {
  // The box starts on the boundary between two voxels, so that faces of boxes do not run through
  // voxel centres; the band fits at positive indices for usual widths.
  const double shift = 7.5 * voxelSize;
  return box.lower - Vec3{shift, shift, shift};
}

openvdb::math::Transform::Ptr latticeTransform(const Vec3& origin, double voxelSize) {
  auto transform = openvdb::math::Transform::createLinearTransform(voxelSize);
  transform->postTranslate(openvdb::Vec3d(origin.x, origin.y, origin.z));
  return transform;
}

FloatGrid::Ptr narrowBand(const SolidBody& body, const Vec3& origin, double voxelSize, double width,
                          const Coord* block) {
  openvdb::initialize();
  const float background = backgroundOf(width);
  const Band band(
      body, origin, voxelSize, 0, background,
      block ? openvdb::CoordBBox::createCube(*block, BlockNode::DIM) : openvdb::CoordBBox::inf());
  const std::vector<Coord> origins = band.leaves();
  std::vector<std::unique_ptr<Leaf>> leaves(origins.size());
  parallelBlocks(
      origins.size(), 16,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          leaves[i] = makeLeaf(body, band, origins[i], voxelSize, background);
        }
      },
      "level set");
  auto grid = FloatGrid::create(background);
  for (std::unique_ptr<Leaf>& leaf : leaves) {
    if (leaf) grid->tree().addLeaf(leaf.release());
  }
  if (block)
    fillBlock(body, band, *block, grid->tree());
  else
    openvdb::tools::signedFloodFill(grid->tree(), true, 1, 1);
  grid->setTransform(latticeTransform(origin, voxelSize));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setName("surface");
  throwIfCancelled();
  return grid;
}

double gridVolume(const SolidBody& body, int resolution) {
  const double h = voxelSizeAcross(body.box(), resolution);
  return insideVolume(*narrowBand(body, latticeOrigin(body.box(), h), h, kUsualHalfWidth * h));
}

}  // namespace innermap
