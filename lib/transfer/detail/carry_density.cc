#include "transfer/detail/carry_density.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/kuhn_cells.h"
#include "evaluate/topology.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "transfer/detail/cell_nodes.h"

namespace innermap {
namespace {

using openvdb::Coord;
using Leaf = openvdb::MaskTree::LeafNodeType;
using MaskReader = openvdb::tree::ValueAccessor<const openvdb::MaskTree, false>;

constexpr char kStage[] = "carrying the densities";
constexpr int kCubeCells = 128;                // along each side of a cube
constexpr std::size_t kLeavesTogether = 256;   // leaves of cells
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

int cubeEdge(int parts) { return kCubeCells / parts; }

Coord cubeOf(const Coord& voxel, int edge) {
  return {floorDivide(voxel.x(), edge), floorDivide(voxel.y(), edge), floorDivide(voxel.z(), edge)};
}

openvdb::CoordBBox voxelsOf(const Coord& cube, int edge) {
  return openvdb::CoordBBox::createCube({edge * cube.x(), edge * cube.y(), edge * cube.z()}, edge);
}

openvdb::MaskTree voxelsIn(const Coord& cube, int parts, const openvdb::MaskTree& voxels) {
  openvdb::MaskTree out;
  out.fill(voxelsOf(cube, cubeEdge(parts)), true, true);
  out.topologyIntersection(voxels);
  return out;
}

void requireFor(const DensityVoxels& source, std::uint64_t bytes) {
  requireMemory("carrying the density \"" + source.grid->getName() + "\"", bytes,
                "use larger voxels, or cut the volume off around the solid");
}

// Of the voxels of one cube.
class DensityCarry {
 public:
  DensityCarry(const DensityVoxels& source, const ExtendedMap& map,
               const openvdb::math::Transform& target, const CarryDensitySettings& settings,
               const Coord& cube)
      : source_(source),
        map_(map),
        settings_(settings),
        carried_(voxelsIn(cube, settings.parts, *source.carried)),
        lattice_(target),
        nodes_(carried_, source.grid->transform(), settings.parts),
        deposit_(voxelVolume(source.grid->transform()) / std::pow(settings.parts, 3),
                 voxelVolume(target)) {
    requireFor(source, CellNodes::memory(nodes_.size()) + kParts);
  }

  DepositedDensity run();

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
  void addTorn(const Coord& cell, const PointImage& middle, const DensityReader& densities,
               Part& part) const;
  void carryTorn(const std::vector<Coord>& torn);
  void take(std::vector<Part>& parts);

  const DensityVoxels& source_;
  const ExtendedMap& map_;
  const CarryDensitySettings& settings_;
  openvdb::MaskTree carried_;
  Lattice lattice_;
  CellNodes nodes_;
  CellDeposit deposit_;
  DepositedDensity made_;
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
  const MaskReader carried(carried_);
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
void DensityCarry::addTorn(const Coord& cell, const PointImage& middle,
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
  const std::vector<PointImage> samples = map_.at(middles);
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
    made_.figures.add(part.figures);
    sums.push_back(std::move(part.sums));
  }
  made_.sums.add(sums);
}

DepositedDensity DensityCarry::run() {
  constexpr double kMapping = 0.3;  // of the time, about
  {
    const PartOfStage mapping(0, kMapping);
    nodes_.map(map_, lattice_, kStage);
  }
  const PartOfStage carrying(kMapping, 1);
  const std::size_t count = nodes_.leaves().size();
  std::vector<Coord> torn;
  for (std::size_t begin = 0; begin < count; begin += kLeavesTogether) {
    std::vector<Part> parts(std::min(kLeavesTogether, count - begin));
    parallelBlocks(parts.size(), 1,
                   [&](std::size_t i, std::size_t) { addLeaf(begin + i, parts[i]); });
    for (const Part& part : parts) torn.insert(torn.end(), part.torn.begin(), part.torn.end());
    take(parts);
    reportProgress(kStage, static_cast<double>(begin + kLeavesTogether) /
                               static_cast<double>(count + kLeavesTogether));
  }
  carryTorn(torn);
  return std::move(made_);
}

// Active voxels of `grid` become 0, and the others as the sums say. What lets volume grow together
// more than `limit` times is thinned: the mass that this leaves out.
template <class Grid>
double write(const VoxelSums& sums, double voxelVolume, double limit, Grid& grid) {
  double cut = 0;
  using Value = typename Grid::ValueType;
  for (auto voxel = grid.beginValueOn(); voxel; ++voxel) voxel.setValue(Value(0));
  for (const auto& [origin, leafSums] : sums.leaves()) {
    typename Grid::TreeType::LeafNodeType* leaf = nullptr;
    for (openvdb::Index i = 0; i < Leaf::SIZE; ++i)
      if (leafSums[i].volume > 0) {
        if (!leaf) leaf = grid.tree().touchLeaf(origin);
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
  const double nodes =
      1.2 * std::min(source * parts * parts * parts, std::pow(1.0 * kCubeCells, 3));
  constexpr std::uint64_t kSummed = 30'000'000;  // of kParts, measured
  return kSummed + CellNodes::memory(static_cast<std::size_t>(nodes)) +
         static_cast<std::uint64_t>(targetVoxels) * sizeof(VoxelSums::Sum);
}

void DepositedDensity::add(DepositedDensity more) {
  figures.add(more.figures);
  std::vector<VoxelSums> parts;
  parts.push_back(std::move(more.sums));
  sums.add(parts);
}

std::map<Coord, std::uint64_t> densityCubes(const openvdb::MaskTree& voxels, int parts) {
  const int edge = cubeEdge(parts);
  std::map<Coord, std::uint64_t> out;
  const auto add = [&](const openvdb::CoordBBox& box, const Leaf* leaf) {
    const Coord first = cubeOf(box.min(), edge), last = cubeOf(box.max(), edge);
    for (auto cube = openvdb::CoordBBox(first, last).begin(); cube; ++cube) {
      openvdb::CoordBBox common = voxelsOf(*cube, edge);
      common.intersect(box);
      std::uint64_t count = common.volume();
      if (leaf)
        for (auto voxel = common.begin(); voxel; ++voxel) count -= !leaf->isValueOn(*voxel);
      if (count > 0) out[*cube] += count;
    }
  };
  auto tile = voxels.cbeginValueOn();
  tile.setMaxDepth(tile.getLeafDepth() - 1);
  for (; tile; ++tile)
    if (!tile.isVoxelValue()) add(tile.getBoundingBox(), nullptr);
  for (auto leaf = voxels.cbeginLeaf(); leaf; ++leaf) add(leaf->getNodeBoundingBox(), &*leaf);
  return out;
}

DepositedDensity carryDensityCube(const DensityVoxels& source, const ExtendedMap& map,
                                  const openvdb::math::Transform& target,
                                  const CarryDensitySettings& settings, const Coord& cube) {
  return DensityCarry(source, map, target, settings, cube).run();
}

openvdb::GridBase::Ptr carryDensity(const DensityVoxels& source, const ExtendedMap& map,
                                    const openvdb::MaskGrid& region, CarriedMass& figures,
                                    const CarryDensitySettings& settings) {
  requireFor(source, kParts + sizeof(VoxelSums::LeafSums) * region.tree().leafCount());
  const auto cubes = densityCubes(*source.carried, settings.parts);
  DepositedDensity all;
  std::size_t done = 0;
  for (const auto& [cube, voxels] : cubes) {
    const auto shareOf = [&](std::size_t n) {
      return static_cast<double>(n) / static_cast<double>(cubes.size());
    };
    const PartOfStage part(shareOf(done), shareOf(done + 1));
    ++done;
    all.add(carryDensityCube(source, map, region.transform(), settings, cube));
  }
  return densityGrid(source, all, region, figures, settings);
}

openvdb::GridBase::Ptr densityGrid(const DensityVoxels& source, const DepositedDensity& all,
                                   const openvdb::MaskGrid& region, CarriedMass& figures,
                                   const CarryDensitySettings& settings) {
  const openvdb::GridBase::Ptr out = emptyLike(*source.grid, region);
  const double volume = voxelVolume(region.transform());
  if (out->isType<openvdb::FloatGrid>())
    figures.cut = write(all.sums, volume, settings.limit, static_cast<openvdb::FloatGrid&>(*out));
  else
    figures.cut = write(all.sums, volume, settings.limit, static_cast<openvdb::DoubleGrid&>(*out));
  double most = 0;
  for (const auto& [origin, sums] : all.sums.leaves())
    for (const VoxelSums::Sum& sum : sums) most = std::max(most, sum.volume);
  const DepositFigures& cells = all.figures;
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
