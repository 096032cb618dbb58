#include "innermap/levelset/level_set.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "levelset/detail/band.h"
#include "levelset/detail/narrow_band.h"
#include "levelset/level_set_settings.h"

namespace innermap {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using openvdb::FloatTree;
using Leaf = FloatTree::LeafNodeType;

std::string formatLength(double length) { return fmt::format("{:.4g}", length); }

// Mean thickness: that of plates, half of that of needles, a third of that of balls.
double thicknessOf(const Solid& solid) { return 2 * solid.volume() / solid.area(); }

// So many voxels in the thickness are at least one layer of centres, wherever the lattice begins.
constexpr double kInThickness = 1.5;

// Voxels that leave something of the thinnest solids; 0 where the thickness is not known.
double thinVoxel(const Solid& solid) { return thicknessOf(solid) / kInThickness; }

// About the most that grids of a map take: their leaves reach some 6 voxels to either side.
double gridBytes(const Solid& solid, double voxel) {
  constexpr double kVoxel = 100, kLayers = 12;
  return kVoxel * (solid.volume() / std::pow(voxel, 3) + kLayers * solid.area() / (voxel * voxel));
}

double automaticVoxel(const Solid& solid) {
  constexpr double kFiner = 0.9, kMostBytes = 4e9, kHopeless = 3;
  const double usual = voxelSizeAcross(solid.box(), kUsualResolution), thin = thinVoxel(solid);
  if (!(thin > 0 && thin < usual)) return usual;
  const double room = limitsMemory() ? 0.5 * static_cast<double>(memoryLimit()) : kMostBytes;
  double voxel = std::max(thin, voxelSizeAcross(solid.box(), kMostVoxels));
  while (voxel < usual && gridBytes(solid, voxel) > room) voxel /= kFiner;
  return voxel > kHopeless * thicknessOf(solid) ? usual : std::min(voxel, usual);
}

int acrossFor(const Solid& solid, double voxel) {
  return static_cast<int>(std::min(std::ceil(longestSide(solid) / voxel), 1e9));
}

// What a thin solid would take.
std::string thinNeed(const Solid& solid) {
  const double voxel = thinVoxel(solid);
  const int across = acrossFor(solid, voxel);
  return fmt::format(
      "a resolution of {} would do{}, in about {} of memory", across,
      across > kMostVoxels ? fmt::format(", more than the {} there are", kMostVoxels) : "",
      formatBytes(static_cast<std::uint64_t>(std::min(gridBytes(solid, voxel), 1e18))));
}

void checkReach(const Solid& solid, const Vec3& origin, double voxelSize) {
  constexpr double kFarthest = 1e9;  // voxels; indices have 32 bits
  for (int a = 0; a < 3; ++a)
    for (const double side : {solid.box().lower[a], solid.box().upper[a]})
      if (!(std::abs(side - origin[a]) < kFarthest * voxelSize))
        throw SettingError("origin", "is over a billion voxels away from the solid");
}

static_assert(kSmallestVoxel == kLeastVoxel);

FloatGrid::Ptr makeBand(const Solid& solid, const LevelSetSettings& settings, const Coord* block) {
  const double h = voxelSizeFor(solid, settings);
  const Vec3 origin = settings.origin.value_or(latticeOrigin(solid.box(), h));
  checkReach(solid, origin, h);
  return narrowBand(solid.body(), origin, h, settings.halfWidth * h, block);
}

}  // namespace

double longestSide(const Solid& solid) {
  const Vec3 e = solid.box().extent();
  return std::max({e.x, e.y, e.z});
}

double voxelSizeFor(const Solid& solid, const LevelSetSettings& settings) {
  const double longest = longestSide(solid);
  if (settings.voxelSize == 0 && settings.resolution == 0) return automaticVoxel(solid);
  if (settings.voxelSize == 0) {
    if (settings.resolution < kLeastVoxels || settings.resolution > kMostVoxels) {
      throw SettingError("resolution", NumberRange{kLeastVoxels, kMostVoxels}.refusal(
                                           std::to_string(settings.resolution), "voxels"));
    }
    return voxelSizeAcross(solid.box(), settings.resolution);
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
  if (longest / settings.voxelSize > kMostVoxels * (1 + 1e-9)) {
    throw SettingError("voxel size",
                       "gives more than 4096 voxels along the longest side; at least " +
                           formatLength(longest / kMostVoxels) + " is needed");
  }
  return settings.voxelSize;
}

std::string voxelSizeNote(const Solid& solid, const LevelSetSettings& settings) {
  if (settings.voxelSize > 0) return {};
  const double voxel = voxelSizeFor(solid, settings);
  if (voxel == kSmallestVoxel)
    return fmt::format(
        "the voxels are {} world units, the smallest that OpenVDB can hold, not as "
        "small as the resolution asks for; scale the meshes up for more",
        kSmallestVoxel);
  if (settings.resolution > 0) return {};
  if (!(thicknessOf(solid) > 0) ||
      thinVoxel(solid) >= voxelSizeAcross(solid.box(), kUsualResolution))
    return {};
  const std::string chosen =
      fmt::format("the solid is thin, {} on average: {} voxels along its longest side",
                  formatLength(thicknessOf(solid)), acrossFor(solid, voxel));
  if (voxel <= thinVoxel(solid)) return chosen + " in place of " + std::to_string(kUsualResolution);
  return chosen + "; " + thinNeed(solid);
}

void requireInterior(std::uint64_t interiorVoxels, const Solid& solid, const std::string& name) {
  if (interiorVoxels > 0) return;
  throw DataError(name +
                  ": is thinner than the voxels everywhere, none has its centre inside; use a "
                  "higher resolution" +
                  (thicknessOf(solid) > 0 ? ": " + thinNeed(solid) : ""));
}

void requireInterior(const Solid& solid, const LevelSetSettings& settings) {
  const double thickness = thicknessOf(solid);
  if (!(thickness > 0) || thickness >= voxelSizeFor(solid, settings)) return;
  requireInterior(interiorVoxels(*makeLevelSet(solid, settings)), solid,
                  solid.repaired().mesh.name);
}

openvdb::math::Transform::Ptr transformFor(const Solid& solid, double voxelSize) {
  return latticeTransform(latticeOrigin(solid.box(), voxelSize), voxelSize);
}

LevelSetSettings onLatticeOf(const Solid& solid, LevelSetSettings settings) {
  settings.voxelSize = voxelSizeFor(solid, settings);
  if (!settings.origin) settings.origin = latticeOrigin(solid.box(), settings.voxelSize);
  return settings;
}

std::uint64_t levelSetMemory(const Solid& solid, const LevelSetSettings& settings) {
  requireDescribed(settings);
  const double h = voxelSizeFor(solid, settings);
  const Band band(solid.body(), latticeOrigin(solid.box(), h), h, 0, settings.halfWidth * h);
  const double leaves = band.estimateLeaves();  // an over-estimate
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
  requireDescribed(settings);
  if (limitsMemory())
    requireMemory("level set", levelSetMemory(solid, settings),
                  "a larger voxel size, a lower resolution or a smaller half width would fit");
  return makeBand(solid, settings, nullptr);
}

FloatGrid::Ptr makeLevelSetBlock(const Solid& solid, const LevelSetSettings& settings,
                                 const Coord& block) {
  return makeBand(solid, settings, &block);
}

FloatGrid::Ptr emptyLevelSet(const Solid& solid, const LevelSetSettings& settings) {
  const double h = voxelSizeFor(solid, settings);
  auto grid = FloatGrid::create(static_cast<float>(settings.halfWidth * h));
  grid->setTransform(transformFor(solid, h));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

std::vector<Setting> describe(LevelSetSettings& s) {
  return {Setting("half_width", "W", &s.halfWidth, "width of the band on each side of the surface")
              .in("voxels")
              .from(2, 100)
              .rare()};
}

}  // namespace innermap
