#include "transfer/detail/cell_deposit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/kuhn_cells.h"
#include "transfer/detail/split_tetrahedron.h"

namespace innermap {
namespace {

constexpr double kWidest = 64;  // voxels
constexpr double kFarthest = 1e9;

double volumeOf(const CellImage& cell, const KuhnCell& kuhn) {
  const auto image = [&](std::size_t k) { return cell.images[static_cast<std::size_t>(kuhn[k])]; };
  const Vec3 p = image(0);
  return dot(image(1) - p, cross(image(2) - p, image(3) - p)) / 6;
}

openvdb::Coord floorOf(const Vec3& p) {
  return openvdb::Coord::floor(openvdb::Vec3d(p.x, p.y, p.z));
}

// Whether all corners are where voxels can be.
bool isPlaced(const CellImage& cell) {
  for (const Vec3& p : cell.images)
    if (!(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < kFarthest)) return false;
  return true;
}

// Of a cell's volume: less than that in a voxel is rounding.
constexpr double kRounding = 1e-13;

// Sums of one cell's image, taken up at once: neighbouring voxels may be in other leaves, and parts
// are taken away from voxels again.
class LocalSums {
 public:
  LocalSums(const openvdb::Coord& lower, const openvdb::Coord& size) : lower_(lower), size_(size) {
    const auto count = static_cast<std::size_t>(size.x() * size.y() * size.z());
    if (count > few_.size()) many_.resize(count);
    sums_ = many_.empty() ? few_.data() : many_.data();
  }

  void add(const openvdb::Coord& voxel, double volume, double mass) {
    const openvdb::Coord at = voxel - lower_;
    VoxelSums::Sum& sum = sums_[(at.x() * size_.y() + at.y()) * size_.z() + at.z()];
    sum.volume += volume;
    sum.mass += mass;
  }

  void addTo(double least, VoxelSums& sums) const {
    const VoxelSums::Sum* sum = sums_;
    for (int x = 0; x < size_.x(); ++x)
      for (int y = 0; y < size_.y(); ++y)
        for (int z = 0; z < size_.z(); ++z, ++sum)
          if (sum->volume > least) sums.add(lower_.offsetBy(x, y, z), sum->volume, sum->mass);
  }

 private:
  openvdb::Coord lower_, size_;
  std::array<VoxelSums::Sum, 256> few_;
  std::vector<VoxelSums::Sum> many_;
  VoxelSums::Sum* sums_;
};

void split(const CellImage& cell, double volume, LocalSums& sums) {
  std::array<TetrahedronCorner, 8> corners;
  for (std::size_t c = 0; c < 8; ++c) {
    const Vec3& p = cell.images[c];
    corners[c] = {{p.x, p.y, p.z}, cell.densities[c]};
  }
  const auto corner = [&](int c) { return &corners[static_cast<std::size_t>(c)]; };
  for (const KuhnCell& kuhn : kKuhnCells)
    splitAtVoxels({corner(kuhn[0]), corner(kuhn[1]), corner(kuhn[2]), corner(kuhn[3])}, volume,
                  [&](const openvdb::Coord& at, double v, double m) { sums.add(at, v, m); });
}

double massOf(const CellImage& cell, double volume) {
  double mass = 0;
  for (const KuhnCell& kuhn : kKuhnCells)
    for (const int c : kuhn) mass += 0.25 * volume * cell.densities[static_cast<std::size_t>(c)];
  return mass;
}

}  // namespace

void DepositFigures::add(const DepositFigures& other) {
  cells += other.cells;
  kept += other.kept;
  turned += other.turned;
  largestCompression = std::max(largestCompression, other.largestCompression);
}

void CellDeposit::count(const CellImage& cell, DepositFigures& figures) const {
  bool kept = false, turned = false;
  for (const KuhnCell& kuhn : kKuhnCells) {
    const double image = volumeOf(cell, kuhn) * targetVolume_;
    (image > 0 ? kept : turned) = true;
    figures.largestCompression =
        std::max(figures.largestCompression, sourceVolume_ / 6 / std::abs(image));
  }
  ++figures.cells;
  figures.kept += kept;
  figures.turned += turned;
}

void CellDeposit::add(const CellImage& cell, VoxelSums& sums, DepositFigures& figures) const {
  if (!isPlaced(cell)) return;
  count(cell, figures);
  Box3 box;
  for (const Vec3& p : cell.images) box.add(p);
  const Vec3 extent = box.extent();
  const double volume = sourceVolume_ / 6;
  const openvdb::Coord lower = floorOf(box.lower),
                       size = floorOf(box.upper) - lower + openvdb::Coord(1);
  if (std::max({extent.x, extent.y, extent.z}) > kWidest)
    return sums.add(floorOf(box.center()), sourceVolume_, massOf(cell, volume));
  const int voxels = size.x() * size.y() * size.z();
  if (voxels == 1) return sums.add(lower, sourceVolume_, massOf(cell, volume));
  LocalSums local(lower, size);
  split(cell, volume, local);
  local.addTo(kRounding * sourceVolume_, sums);
}

}  // namespace innermap
