#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "innermap/core/run.h"
#include "innermap/levelset/level_set.h"

namespace innermap {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;

constexpr std::size_t kSamples = 20000;

// Both signs within two voxels of p. (Not every pair of neighbours need be looked at: where both
// signs occur, the level set passes between them.)
bool hasSignChange(const FloatGrid::ConstAccessor& values, const openvdb::Vec3d& index) {
  const Coord center = Coord::round(index);
  const bool inside = values.getValue(center) < 0;
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      for (int z = -2; z <= 2; ++z) {
        if ((values.getValue(center.offsetBy(x, y, z)) < 0) != inside) return true;
      }
    }
  }
  return false;
}

double lostShare(const FloatGrid& levelSet, const Mesh& surface) {
  std::vector<double> cumulative;
  cumulative.reserve(surface.triangles.size());
  double sum = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    cumulative.push_back(sum += norm(areaVector(surface, static_cast<int>(t))));
  }
  if (!(sum > 0)) return 1;
  const CounterRandom random(1, 0x6c6f7374);
  constexpr std::size_t kBlock = 500;
  std::vector<std::size_t> lost(kSamples / kBlock, 0);
  parallelBlocks(kSamples, kBlock, [&](std::size_t begin, std::size_t end) {
    const FloatGrid::ConstAccessor values = levelSet.getConstAccessor();
    for (std::size_t i = begin; i < end; ++i) {
      const double u = (static_cast<double>(i) + random.uniform(3 * i)) / kSamples * sum;
      const std::size_t t = std::min<std::size_t>(
          std::upper_bound(cumulative.begin(), cumulative.end(), u) - cumulative.begin(),
          cumulative.size() - 1);
      const double r = std::sqrt(random.uniform(3 * i + 1)), s = random.uniform(3 * i + 2);
      const SurfacePoint point{static_cast<int>(t), {1 - r, r * (1 - s), r * s}};
      const Vec3 p = positionOf(surface, point);
      if (!hasSignChange(values, levelSet.worldToIndex(openvdb::Vec3d(p.x, p.y, p.z)))) {
        ++lost[begin / kBlock];
      }
    }
  });
  std::size_t total = 0;
  for (const std::size_t n : lost) total += n;
  return static_cast<double>(total) / kSamples;
}

}  // namespace

LevelSetCheck checkLevelSet(const FloatGrid& levelSet, const Solid& solid) {
  LevelSetCheck check;
  check.meshVolume = solid.volume();
  check.gridVolume = insideVolume(levelSet);
  check.volumeError = std::abs(check.gridVolume - check.meshVolume) / check.meshVolume;
  check.lostSurface = lostShare(levelSet, solid.surface());
  if (!(check.volumeError <= 0.01)) {
    check.warnings.push_back(
        fmt::format("the level set's volume differs from the mesh's by {:.3g}%; use smaller voxels",
                    100 * check.volumeError));
  }
  if (check.lostSurface > 0.001) {
    check.warnings.push_back(
        fmt::format("{:.3g}% of the surface is thinner than the voxels and lost in the level set; "
                    "use smaller voxels",
                    100 * check.lostSurface));
  }
  return check;
}

std::uint64_t interiorVoxels(const FloatGrid& levelSet) {
  std::uint64_t count = 0;
  for (auto it = levelSet.cbeginValueAll(); it; ++it)
    if (*it < 0) count += it.getVoxelCount();
  return count;
}

}  // namespace innermap
