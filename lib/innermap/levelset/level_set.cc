#include "innermap/levelset/level_set.h"

#include <fmt/format.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <cmath>
#include <memory>
#include <numeric>

#include "innermap/core/memory.h"
#include "innermap/core/parallel.h"
#include "innermap/levelset/detail/band.h"

namespace innermap {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using openvdb::FloatTree;
using Leaf = FloatTree::LeafNodeType;

constexpr int kMaxAcross = 4096;
constexpr int kMinAcross = 4;

// Rounded up: the band is as wide as asked in single precision too.
float backgroundOf(double width) {
  const float f = static_cast<float>(width);
  return f < width ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

std::string formatLength(double length) { return fmt::format("{:.4g}", length); }

double longestSide(const Solid& solid) {
  const Vec3 e = solid.box().extent();
  return std::max({e.x, e.y, e.z});
}

void checkHalfWidth(const LevelSetSettings& settings) {
  if (!(settings.halfWidth >= 2 && settings.halfWidth <= 100)) {
    throw SettingError("halfWidth", "must lie between 2 and 100 voxels");
  }
}

Vec3 originOf(const Solid& solid, double voxelSize) {
  // The box starts on the boundary between two voxels, so that faces of boxes do not run through
  // voxel centres; the band fits at positive indices for usual widths.
  const double shift = 7.5 * voxelSize;
  return solid.box().lower - Vec3{shift, shift, shift};
}

void checkReach(const Solid& solid, const Vec3& origin, double voxelSize) {
  constexpr double kFarthest = 1e9;  // voxels; indices have 32 bits
  for (int a = 0; a < 3; ++a)
    for (const double side : {solid.box().lower[a], solid.box().upper[a]})
      if (!(std::abs(side - origin[a]) < kFarthest * voxelSize))
        throw SettingError("origin", "is over a billion voxels away from the solid");
}

openvdb::math::Transform::Ptr transformAt(const Vec3& origin, double voxelSize) {
  auto transform = openvdb::math::Transform::createLinearTransform(voxelSize);
  transform->postTranslate(openvdb::Vec3d(origin.x, origin.y, origin.z));
  return transform;
}

// Signs of one leaf's voxels. Two neighbours have the same sign when the balls about them that are
// free of surface meet; one winding number settles each set of voxels so connected.
class LeafSigns {
 public:
  LeafSigns(const Solid& solid, const Band& band, const Coord& leaf, double voxelSize,
            const double* distances)
      : distances_(distances) {
    std::iota(parent_.begin(), parent_.end(), 0);
    // More than one voxel by a margin for rounding: faces often lie just between two voxels.
    const double reach = (1 + 1e-6) * voxelSize + 2 * solid.gap();
    for (int x = 0; x < 8; ++x) {
      for (int y = 0; y < 8; ++y) {
        for (int z = 0; z < 8; ++z) {
          const int i = x << 6 | y << 3 | z;
          if (x < 7) connect(i, i + 64, reach);
          if (y < 7) connect(i, i + 8, reach);
          if (z < 7) connect(i, i + 1, reach);
        }
      }
    }
    // The farthest voxel of a set speaks for it.
    std::array<int, Band::kLeafVoxels> speaker;
    speaker.fill(-1);
    for (int i = 0; i < Band::kLeafVoxels; ++i) {
      int& s = speaker[root(i)];
      if (s < 0 || distances[i] > distances[s]) s = i;
    }
    for (int i = 0; i < Band::kLeafVoxels; ++i) {
      if (speaker[i] < 0) continue;
      const int s = speaker[i];
      inside_[i] = solid.inside(band.position(leaf.offsetBy(s >> 6, s >> 3 & 7, s & 7)));
    }
  }

  bool inside(int i) { return inside_[root(i)]; }

 private:
  void connect(int i, int j, double reach) {
    if (!(distances_[i] + distances_[j] > reach)) return;
    i = root(i);
    j = root(j);
    parent_[std::max(i, j)] = std::min(i, j);
  }
  int root(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  const double* distances_;
  std::array<int, Band::kLeafVoxels> parent_;
  std::array<bool, Band::kLeafVoxels> inside_{};
};

// Null when no voxel is in the band.
std::unique_ptr<Leaf> makeLeaf(const Solid& solid, const Band& band, const Coord& origin,
                               double voxelSize, float background) {
  std::array<double, Band::kLeafVoxels> distances;
  band.distances(origin, distances.data());
  // After rounding to float the value must still be within the background.
  const auto inBand = [&](double d) { return static_cast<float>(d) < background; };
  if (std::none_of(distances.begin(), distances.end(), inBand)) return nullptr;
  LeafSigns signs(solid, band, origin, voxelSize, distances.data());
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

}  // namespace

double voxelSizeFor(const Solid& solid, const LevelSetSettings& settings) {
  const double longest = longestSide(solid);
  if (settings.voxelSize == 0) {
    if (settings.resolution < kMinAcross || settings.resolution > kMaxAcross) {
      throw SettingError("resolution", "must lie between 4 and 4096 voxels");
    }
    if (longest / kMinAcross < kSmallestVoxel) {
      throw DataError("the solid is " + formatLength(longest) +
                      " across, too small for OpenVDB, whose voxels cannot be under " +
                      formatLength(kSmallestVoxel) + "; scale the mesh up");
    }
    return std::max(longest / settings.resolution, kSmallestVoxel);
  }
  if (!(settings.voxelSize > 0) || !std::isfinite(settings.voxelSize)) {
    throw SettingError("voxel size",
                       "must be a positive length, or 0 to let the resolution decide");
  }
  if (settings.voxelSize < kSmallestVoxel) {
    throw SettingError("voxel size", "OpenVDB cannot hold voxels under " +
                                         formatLength(kSmallestVoxel) +
                                         " world units; scale the mesh up or use larger voxels");
  }
  // Rounding aside, the size that a resolution of 4096 gives is allowed.
  if (longest / settings.voxelSize > kMaxAcross * (1 + 1e-9)) {
    throw SettingError("voxel size",
                       "gives more than 4096 voxels along the longest side; at least " +
                           formatLength(longest / kMaxAcross) + " is needed");
  }
  return settings.voxelSize;
}

openvdb::math::Transform::Ptr transformFor(const Solid& solid, double voxelSize) {
  return transformAt(originOf(solid, voxelSize), voxelSize);
}

std::uint64_t levelSetMemory(const Solid& solid, const LevelSetSettings& settings) {
  checkHalfWidth(settings);
  const double h = voxelSizeFor(solid, settings);
  const Band band(solid, originOf(solid, h), h, 0, settings.halfWidth * h);
  const double leaves = 1.25 * band.estimateLeaves(settings.progress);
  const double leafBytes = sizeof(Leaf) + Band::kLeafVoxels * sizeof(float) + 3 * sizeof(Coord);
  // Nodes of 128 voxels a side hold 256 leaves of a flat surface; half of that is common.
  const double middleNodes = leaves / 100 + 8;
  using Upper = FloatTree::RootNodeType::ChildNodeType;
  using Middle = Upper::ChildNodeType;
  const double upperNodes = 8;
  const double bytes =
      leaves * leafBytes + middleNodes * sizeof(Middle) + upperNodes * sizeof(Upper);
  return static_cast<std::uint64_t>(bytes);
}

FloatGrid::Ptr makeLevelSet(const Solid& solid, const LevelSetSettings& settings) {
  checkHalfWidth(settings);
  const double h = voxelSizeFor(solid, settings);
  const float background = backgroundOf(settings.halfWidth * h);
  if (settings.maxMemory > 0) {
    requireMemory("level set", levelSetMemory(solid, settings), settings.maxMemory,
                  "a larger voxel size, a lower resolution or a smaller half width would fit");
  }
  openvdb::initialize();
  const Vec3 origin = settings.origin.value_or(originOf(solid, h));
  checkReach(solid, origin, h);
  const Band band(solid, origin, h, 0, background);
  const std::vector<Coord> origins = band.leaves(settings.progress);
  std::vector<std::unique_ptr<Leaf>> leaves(origins.size());
  parallelBlocks(
      origins.size(), 16,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          leaves[i] = makeLeaf(solid, band, origins[i], h, background);
        }
      },
      settings.progress, "level set");
  auto grid = FloatGrid::create(background);
  for (std::unique_ptr<Leaf>& leaf : leaves) {
    if (leaf) grid->tree().addLeaf(leaf.release());
  }
  openvdb::tools::signedFloodFill(grid->tree(), true, 1, 1);
  grid->setTransform(transformAt(origin, h));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setName("surface");
  throwIfCancelled(settings.progress);
  return grid;
}

}  // namespace innermap
