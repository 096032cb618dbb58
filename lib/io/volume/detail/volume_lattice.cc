#include "io/volume/detail/volume_lattice.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>

namespace innermap {

void VolumeLattice::setAxis(int across) {
  axis = across;
  columnAxis = axis == 0 ? 2 : 0;
  rowAxis = axis == 1 ? 2 : 1;
}

std::uint64_t VolumeLattice::voxels() const {
  return std::uint64_t(size.x()) * std::uint64_t(size.y()) * std::uint64_t(size.z());
}

openvdb::Coord VolumeLattice::coord(int column, int row, int slice) const {
  openvdb::Coord c = origin;
  c[axis] += slice;
  c[columnAxis] += column;
  c[rowAxis] += rowsUp ? height() - 1 - row : row;
  return c;
}

openvdb::CoordBBox VolumeLattice::box() const {
  return {origin, origin + size.offsetBy(-1, -1, -1)};
}

openvdb::BBoxd VolumeLattice::worldBox() const {
  openvdb::BBoxd world;
  for (int corner = 0; corner < 8; ++corner) {
    openvdb::Vec3d at = origin.asVec3d() - openvdb::Vec3d(0.5);
    for (int a = 0; a < 3; ++a)
      if (corner >> a & 1) at[a] += size[a];
    world.expand(indexToWorld.transform(at));
  }
  return world;
}

openvdb::Mat4d VolumeLattice::textureToWorld() const {
  openvdb::Mat4d toIndex = openvdb::Mat4d::identity();
  toIndex.setToScale(size.asVec3d());
  toIndex.postTranslate(origin.asVec3d() - openvdb::Vec3d(0.5));
  return toIndex * indexToWorld;
}

std::pair<int, int> nearSquareTiles(int width, int height, int slices) {
  using Score = std::tuple<std::int64_t, std::int64_t, int>;  // longer side, empty tiles, rows
  Score best{INT64_MAX, 0, 0};
  std::pair<int, int> tiles{slices, 1};
  // Beside the square the longer side only grows.
  const double ideal = std::sqrt(double(slices) * height / width);
  const int least = std::max(1, static_cast<int>(ideal / 2) - 1);
  const int most = static_cast<int>(std::min<double>(slices, 2 * ideal + 2));
  for (int columns = std::min(least, slices); columns <= most; ++columns) {
    const int rows = (slices + columns - 1) / columns;
    const std::int64_t w = std::int64_t(columns) * width, h = std::int64_t(rows) * height;
    const Score score{std::max(w, h), std::int64_t(columns) * rows - slices, rows};
    if (score >= best) continue;
    best = score;
    tiles = {columns, rows};
  }
  return tiles;
}

int powerOfTwo(int n) {
  int power = 1;
  while (power < n) power *= 2;
  return power;
}

}  // namespace innermap
