#include "transfer/detail/carry_density.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/kuhn_cells.h"
#include "evaluate/topology.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "transfer/detail/cell_deposit.h"
#include "transfer/detail/cell_nodes.h"

namespace innermap {
namespace {

using openvdb::Coord;
using Leaf = openvdb::MaskTree::LeafNodeType;
using MaskReader = openvdb::tree::ValueAccessor<const openvdb::MaskTree, false>;

constexpr char kStage[] = "carrying the densities";
constexpr std::size_t kTogether = 256;         // leaves of cells
constexpr std::uint64_t kParts = 100'000'000;  // bytes of what is summed by itself, about
// An edge that is so many times as long as the derivative at its ends says lies across a jump: its
// ends belong to parts of the solid that touch in the source and do not in the target.
constexpr double kTorn = 2;

double voxelVolume(const openvdb::math::Transform& transform) {
  return std::abs(transform.baseMap()->determinant());
}

// The densities at the corners of a cell.
std::array<double, 8> cornersOf(const LinearDensity& density, const Coord& cell, const Coord& voxel,
                                int parts) {
  const Coord within =
      cell - openvdb::Coord(parts * voxel.x(), parts * voxel.y(), parts * voxel.z());
  std::array<double, 8> out;
  for (std::size_t c = 0; c < 8; ++c) {
    const Vec3 step{static_cast<double>(c & 1), static_cast<double>(c >> 1 & 1),
                    static_cast<double>(c >> 2)};
    const Vec3 at = (Vec3{static_cast<double>(within.x()), static_cast<double>(within.y()),
                          static_cast<double>(within.z())} +
                     step) /
                        parts -
                    Vec3{0.5, 0.5, 0.5};
    out[c] = density.mean + dot(density.slope, at);
  }
  return out;
}

bool isTorn(const std::array<Vec3, 8>& images, const std::array<float, 8>& stretch) {
  for (std::size_t c = 0; c < 8; ++c)
    for (const std::size_t step : {1, 2, 4}) {
      if (c & step) continue;
      const double most = kTorn * std::max(stretch[c], stretch[c | step]);
      if (!(squaredNorm(images[c | step] - images[c]) <= most * most)) return true;
    }
  return false;
}

class DensityCarry {
 public:
  DensityCarry(const DensityVoxels& source, const ExtendedMap& map, const openvdb::MaskGrid& region,
               const CarryDensitySettings& settings)
      : source_(source),
        map_(map),
        settings_(settings),
        lattice_(region.transform()),
        nodes_(*source.carried, source.grid->transform(), settings.parts),
        deposit_(voxelVolume(source.grid->transform()) / std::pow(settings.parts, 3),
                 voxelVolume(region.transform())) {
    requireMemory("carrying the density \"" + source.grid->getName() + "\"",
                  CellNodes::memory(nodes_.size()) + kParts +
                      sizeof(VoxelSums::LeafSums) * region.tree().leafCount(),
                  "use larger voxels, or cut the volume off around the solid");
  }

  void run();

  const VoxelSums& sums() const { return sums_; }
  const DepositFigures& figures() const { return figures_; }

 private:
  // What is summed by one thread.
  struct Part {
    VoxelSums sums;
    DepositFigures figures;
    std::vector<Coord> torn;
  };

  void addLeaf(std::size_t leaf, Part& part) const;
  void addCells(const openvdb::CoordBBox& cells, const Coord& voxel, const LinearDensity& density,
                const Coord& origin, const CellNodes::Corners& corners, Part& part) const;
  void addTorn(const Coord& cell, const ExtendedSample& middle, const DensityReader& densities,
               Part& part) const;
  void carryTorn(const std::vector<Coord>& torn);
  void take(std::vector<Part>& parts);

  const DensityVoxels& source_;
  const ExtendedMap& map_;
  const CarryDensitySettings& settings_;
  Lattice lattice_;
  CellNodes nodes_;
  CellDeposit deposit_;
  VoxelSums sums_;
  DepositFigures figures_;
};

void DensityCarry::addCells(const openvdb::CoordBBox& cells, const Coord& voxel,
                            const LinearDensity& density, const Coord& origin,
                            const CellNodes::Corners& corners, Part& part) const {
  constexpr int kSide = CellNodes::kSide;
  CellImage image;
  std::array<float, 8> stretch;
  for (auto cell = cells.begin(); cell; ++cell) {
    const Coord local = *cell - origin;
    for (int c = 0; c < 8; ++c) {
      const Coord at = cornerOf(local, c);
      const auto n = static_cast<std::size_t>((at.x() * kSide + at.y()) * kSide + at.z());
      image.images[static_cast<std::size_t>(c)] = corners.images[n];
      stretch[static_cast<std::size_t>(c)] = corners.stretch[n];
    }
    if (isTorn(image.images, stretch)) {
      part.torn.push_back(*cell);
      continue;
    }
    image.densities = cornersOf(density, *cell, voxel, settings_.parts);
    deposit_.add(image, part.sums, part.figures);
  }
}

void DensityCarry::addLeaf(std::size_t leaf, Part& part) const {
  CellNodes::Corners corners;
  nodes_.corners(leaf, corners);
  const MaskReader carried(*source_.carried);
  const std::unique_ptr<DensityReader> densities = readerOf(*source_.grid, settings_.constant);
  const openvdb::CoordBBox inLeaf = nodes_.leaves()[leaf].getNodeBoundingBox();
  const openvdb::CoordBBox voxels(nodes_.voxelOf(inLeaf.min()), nodes_.voxelOf(inLeaf.max()));
  for (auto voxel = voxels.begin(); voxel; ++voxel) {
    if (!carried.isValueOn(*voxel)) continue;
    const int k = settings_.parts;
    openvdb::CoordBBox cells = openvdb::CoordBBox::createCube(
        Coord(k * (*voxel).x(), k * (*voxel).y(), k * (*voxel).z()), k);
    cells.intersect(inLeaf);
    addCells(cells, *voxel, densities->at(*voxel), inLeaf.min(), corners, part);
  }
}

// A torn cell goes with its middle and the map's derivative there.
void DensityCarry::addTorn(const Coord& cell, const ExtendedSample& middle,
                           const DensityReader& densities, Part& part) const {
  const Coord voxel = nodes_.voxelOf(cell);
  CellImage image;
  image.densities = cornersOf(densities.at(voxel), cell, voxel, settings_.parts);
  const Vec3 at = lattice_.toIndex(middle.image) + Vec3{0.5, 0.5, 0.5};
  for (std::size_t c = 0; c < 8; ++c) {
    Vec3 way;
    for (std::size_t a = 0; a < 3; ++a) way += (c >> a & 1 ? 0.5 : -0.5) * nodes_.edges()[a];
    image.images[c] = at + lattice_.linear * (middle.jacobian * way);
  }
  deposit_.add(image, part.sums, part.figures);
}

void DensityCarry::carryTorn(const std::vector<Coord>& torn) {
  constexpr std::size_t kBlock = 1024;
  Points middles;
  for (const Coord& cell : torn)
    middles.push_back(nodes_.worldOf(cell.asVec3d() + openvdb::Vec3d(0.5)));
  const std::vector<ExtendedSample> samples = map_.at(middles);
  std::vector<Part> parts((torn.size() + kBlock - 1) / kBlock);
  parallelBlocks(torn.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    const std::unique_ptr<DensityReader> densities = readerOf(*source_.grid, settings_.constant);
    for (std::size_t i = begin; i < end; ++i)
      addTorn(torn[i], samples[i], *densities, parts[begin / kBlock]);
  });
  take(parts);
}

void DensityCarry::take(std::vector<Part>& parts) {
  std::vector<VoxelSums> sums;
  for (Part& part : parts) {
    figures_.add(part.figures);
    sums.push_back(std::move(part.sums));
  }
  sums_.add(sums);
}

void DensityCarry::run() {
  nodes_.map(map_, lattice_);
  const std::size_t count = nodes_.leaves().size();
  std::vector<Coord> torn;
  for (std::size_t begin = 0; begin < count; begin += kTogether) {
    std::vector<Part> parts(std::min(kTogether, count - begin));
    parallelBlocks(parts.size(), 1,
                   [&](std::size_t i, std::size_t) { addLeaf(begin + i, parts[i]); });
    for (const Part& part : parts) torn.insert(torn.end(), part.torn.begin(), part.torn.end());
    take(parts);
    reportProgress(kStage,
                   static_cast<double>(begin + kTogether) / static_cast<double>(count + kTogether));
  }
  carryTorn(torn);
}

// Active voxels of `grid` become 0, and the others as the sums say. What lets volume grow together
// more than `limit` times is thinned: the mass that this leaves out.
template <class Grid>
double write(const VoxelSums& sums, double voxelVolume, double limit, Grid& grid) {
  double cut = 0;
  using Value = typename Grid::ValueType;
  for (auto voxel = grid.beginValueOn(); voxel; ++voxel) voxel.setValue(Value(0));
  for (const auto& [origin, leafSums] : sums.leaves()) {
    auto* leaf = grid.tree().touchLeaf(origin);
    for (openvdb::Index i = 0; i < Leaf::SIZE; ++i)
      if (leafSums[i].volume > 0) {
        const double share = std::min(1.0, limit * voxelVolume / leafSums[i].volume);
        leaf->setValueOn(i, static_cast<Value>(share * leafSums[i].mass / voxelVolume));
        cut += (1 - share) * leafSums[i].mass;
      }
  }
  return cut;
}

}  // namespace

std::uint64_t densityMemory(std::uint64_t sourceVoxels, double targetVoxels) {
  // Where the target's voxels are finer than those of the source, these are cut so far (push.cc);
  // along the surface cells have more corners than there are cells.
  const double source = std::max(1.0, static_cast<double>(sourceVoxels));
  const double parts = std::clamp(std::floor(std::cbrt(targetVoxels / source) + 0.25), 1.0, 32.0);
  const double nodes = 1.2 * source * parts * parts * parts;
  constexpr std::uint64_t kSummed = 30'000'000;  // of kParts, measured
  return kSummed + CellNodes::memory(static_cast<std::size_t>(nodes)) +
         static_cast<std::uint64_t>(targetVoxels) * sizeof(VoxelSums::Sum);
}

openvdb::GridBase::Ptr carryDensity(const DensityVoxels& source, const ExtendedMap& map,
                                    const openvdb::MaskGrid& region, CarriedMass& figures,
                                    const CarryDensitySettings& settings) {
  DensityCarry carry(source, map, region, settings);
  carry.run();
  const openvdb::GridBase::Ptr out = emptyLike(*source.grid, region);
  const double volume = voxelVolume(region.transform());
  if (out->isType<openvdb::FloatGrid>())
    figures.cut =
        write(carry.sums(), volume, settings.limit, static_cast<openvdb::FloatGrid&>(*out));
  else
    figures.cut =
        write(carry.sums(), volume, settings.limit, static_cast<openvdb::DoubleGrid&>(*out));
  double most = 0;
  for (const auto& [origin, sums] : carry.sums().leaves())
    for (const VoxelSums::Sum& sum : sums) most = std::max(most, sum.volume);
  const DepositFigures& cells = carry.figures();
  figures.name = source.grid->getName();
  figures.before = source.mass;
  figures.left = source.left;
  figures.after = massOf(*out);
  figures.largestRatio = most / volume;
  figures.largestCompression = cells.largestCompression;
  figures.cells = cells.cells;
  // The map may mirror all of the solid.
  figures.foldedCells = std::min(cells.kept, cells.turned);
  return out;
}

}  // namespace innermap
