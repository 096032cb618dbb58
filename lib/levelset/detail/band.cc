#include "levelset/detail/band.h"

#include <array>
#include <cmath>

#include "innermap/core/run.h"

namespace innermap {
namespace {

using openvdb::Coord;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
const double kSqrt3 = std::sqrt(3.0);

// Half the diagonal of the box of voxel centres of a block, in voxels.
double blockRadius(int size) { return 0.5 * (size - 1) * kSqrt3; }

// Bounds are widened by this, in voxels: rounding must not lose the point that gave the bound.
constexpr double kSlack = 1e-6;

}  // namespace

struct Band::Level {
  int size = 0;  // voxels along a block's side: 8 times a power of two
  std::vector<Coord> corners;
};

Band::Band(const SolidBody& body, const Vec3& origin, double voxelSize, double lower, double upper,
           const openvdb::CoordBBox& within)
    : body_(body),
      origin_(origin),
      voxelSize_(voxelSize),
      lower_(lower),
      upper_(upper),
      within_(within) {}

Vec3 Band::position(const Coord& voxel) const {
  return origin_ + voxelSize_ * Vec3{double(voxel[0]), double(voxel[1]), double(voxel[2])};
}

bool Band::mayTouch(const Coord& corner, int size) const {
  if (!within_.hasOverlap({corner, corner.offsetBy(size - 1)})) return false;
  const double half = 0.5 * (size - 1) * voxelSize_;
  const Vec3 center = position(corner) + Vec3{half, half, half};
  const double radius = (blockRadius(size) + kSlack) * voxelSize_;
  if (radius >= lower_) return body_.tree().hasCloser(center, upper_ + radius);
  const ClosestPoint found = body_.closest(center, upper_ + radius);
  return found.address.triangle >= 0 && found.distance + radius >= lower_;
}

Band::Level Band::firstLevel() const {
  const Box3& box = body_.box();
  Coord lower, upper;
  int extent = 1;
  for (int a = 0; a < 3; ++a) {
    lower[a] = static_cast<int>(std::floor((box.lower[a] - upper_ - origin_[a]) / voxelSize_)) - 1;
    upper[a] = static_cast<int>(std::ceil((box.upper[a] + upper_ - origin_[a]) / voxelSize_)) + 1;
    extent = std::max(extent, upper[a] - lower[a] + 1);
  }
  Level level;
  level.size = kLeaf;
  while (level.size < extent / 4) level.size *= 2;
  for (int a = 0; a < 3; ++a) lower[a] &= ~(level.size - 1);  // rounds down, negatives too
  for (int x = lower[0]; x <= upper[0]; x += level.size) {
    for (int y = lower[1]; y <= upper[1]; y += level.size) {
      for (int z = lower[2]; z <= upper[2]; z += level.size) {
        if (mayTouch({x, y, z}, level.size)) level.corners.push_back({x, y, z});
      }
    }
  }
  return level;
}

Band::Level Band::refined(const Level& level) const {
  const int half = level.size / 2;
  const auto child = [&](std::size_t block, int c) {
    return level.corners[block].offsetBy(c & 4 ? half : 0, c & 2 ? half : 0, c & 1 ? half : 0);
  };
  std::vector<unsigned char> kept(level.corners.size(), 0);
  parallelBlocks(kept.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      for (int c = 0; c < 8; ++c) {
        if (mayTouch(child(b, c), half)) kept[b] |= static_cast<unsigned char>(1 << c);
      }
    }
  });
  Level finer;
  finer.size = half;
  for (std::size_t b = 0; b < kept.size(); ++b) {
    for (int c = 0; c < 8; ++c) {
      if (kept[b] >> c & 1) finer.corners.push_back(child(b, c));
    }
  }
  return finer;
}

std::vector<Coord> Band::leaves() const {
  Level level = firstLevel();
  while (level.size > kLeaf) level = refined(level);
  return std::move(level.corners);
}

double Band::estimateLeaves() const {
  Level level = firstLevel();
  while (level.size > kLeaf && level.corners.size() < 4000) level = refined(level);
  // Blocks of side s fill the band and about 1.7 s beyond it, whose volume is what stays when they
  // are divided.
  const double band = 2 * (upper_ - lower_) / voxelSize_;
  const double fill = (band + 1.7 * kLeaf) / (band + 1.7 * level.size);
  const double ratio = static_cast<double>(level.size) / kLeaf;
  return static_cast<double>(level.corners.size()) * fill * ratio * ratio * ratio;
}

// A leaf's values, and for each size of blocks the triangles that its voxels may be closest to.
struct Band::Filling {
  openvdb::Coord leaf;
  double* values;
  std::array<TriangleTree::Part, 4> near;

  double* row(const Coord& voxel) const {
    const Coord at = voxel - leaf;
    return values + (at[0] << 6 | at[1] << 3 | at[2]);
  }
};

void Band::fill(const Coord& corner, int size, double bound, const TriangleTree::Part& near,
                Filling& filling) const {
  const double half = 0.5 * (size - 1) * voxelSize_;
  const Vec3 center = position(corner) + Vec3{half, half, half};
  const double radius = blockRadius(size) * voxelSize_;
  const double slack = kSlack * voxelSize_;
  const double within = std::min(bound, upper_ + radius) + slack;
  const ClosestPoint found = body_.tree().closest(center, within, near);
  const bool far = found.address.triangle < 0;
  if (size == 1) {
    *filling.row(corner) = far ? kInfinity : found.distance;
    return;
  }
  if (far || found.distance + radius + slack < lower_) {
    for (int x = 0; x < size; ++x) {
      for (int y = 0; y < size; ++y) {
        double* row = filling.row(corner.offsetBy(x, y, 0));
        std::fill(row, row + size, far ? kInfinity : 0.0);
      }
    }
    return;
  }
  // What is closest to a voxel is no farther from the centre than by twice the radius more.
  TriangleTree::Part& nearer = filling.near[size / 4];
  body_.tree().collect(center, std::min(found.distance + 2 * radius, upper_ + radius) + slack, near,
                       nearer);
  const double childBound = found.distance + 0.25 * size * kSqrt3 * voxelSize_;
  const int s = size / 2;
  for (int c = 0; c < 8; ++c)
    fill(corner.offsetBy(c & 4 ? s : 0, c & 2 ? s : 0, c & 1 ? s : 0), s, childBound, nearer,
         filling);
}

void Band::distances(const Coord& leaf, double* values) const {
  const double half = 0.5 * (kLeaf - 1) * voxelSize_,
               reach = upper_ + (blockRadius(kLeaf) + kSlack) * voxelSize_;
  Filling filling{leaf, values, {}};
  TriangleTree::Part& near = filling.near[3];
  body_.tree().collect(position(leaf) + Vec3{half, half, half}, reach, near);
  fill(leaf, kLeaf, kInfinity, near, filling);
}

}  // namespace innermap
