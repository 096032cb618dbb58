#include "tetra/detail/block_shares.h"

#include <algorithm>
#include <cmath>

#include "innermap/core/run.h"
#include "innermap/levelset/level_set.h"

namespace innermap {
namespace {

// Voxels along a half block: as fine as 128 across, but no fewer than 2.
int voxelsAHalf(int across) { return std::max(2, 64 / across); }

LevelSetSettings voxelsFor(const Solid& solid, int across) {
  LevelSetSettings settings;
  const Vec3 extent = solid.box().extent();
  settings.voxelSize =
      std::max({extent.x, extent.y, extent.z}) / across / (2 * voxelsAHalf(across));
  return settings;
}

}  // namespace

BlockShares::BlockShares(const Solid& solid, int across) {
  LevelSetSettings settings = voxelsFor(solid, across);
  const int n = voxelsAHalf(across);
  const double voxel = settings.voxelSize;
  edge_ = 2 * n * voxel;
  // The solid in the middle of whole blocks, and two layers around it.
  Vec3 first;
  for (int a = 0; a < 3; ++a) {
    const int blocks =
        std::max(1, static_cast<int>(std::ceil(solid.box().extent()[a] / edge_ - 1e-6)));
    halves_[a] = 2 * (blocks + 4);
    lower_[a] = solid.box().center()[a] - 0.5 * (blocks + 4) * edge_;
    first[a] = lower_[a] + 0.5 * voxel;
  }
  settings.origin = first;
  const openvdb::FloatGrid::Ptr levelSet = makeLevelSet(solid, settings);
  share_.assign(static_cast<std::size_t>(halves_[0]) * halves_[1] * halves_[2], 0);
  parallelBlocks(static_cast<std::size_t>(halves_[2]), 1, [&](std::size_t begin, std::size_t end) {
    auto values = levelSet->getConstAccessor();
    for (int z = static_cast<int>(begin); z < static_cast<int>(end); ++z)
      for (int y = 0; y < halves_[1]; ++y)
        for (int x = 0; x < halves_[0]; ++x) {
          double sum = 0;
          for (int k = 0; k < n; ++k)
            for (int j = 0; j < n; ++j)
              for (int i = 0; i < n; ++i)
                sum += std::clamp(0.5 - values.getValue({x * n + i, y * n + j, z * n + k}) / voxel,
                                  0.0, 1.0);
          share_[(static_cast<std::size_t>(z) * halves_[1] + y) * halves_[0] + x] =
              static_cast<float>(sum / (n * n * n));
        }
  });
}

BlockSet BlockShares::lattice(int shift) const {
  BlockSet out;
  out.edge = edge_;
  for (int a = 0; a < 3; ++a) {
    out.size[a] = halves_[a] / 2 - (shift >> a & 1);
    out.lower[a] = lower_[a] + 0.5 * edge_ * (shift >> a & 1);
  }
  out.filled.assign(static_cast<std::size_t>(out.size[0]) * out.size[1] * out.size[2], 0);
  return out;
}

std::vector<double> BlockShares::shares(const BlockSet& lattice, int shift) const {
  std::vector<double> out(lattice.filled.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Block b = lattice.block(i);
    for (int o = 0; o < 8; ++o) {
      std::array<int, 3> h;
      for (int a = 0; a < 3; ++a) h[a] = 2 * b[a] + (shift >> a & 1) + (o >> a & 1);
      out[i] += half(h) / 8.0;
    }
  }
  return out;
}

}  // namespace innermap
