#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "report/page/page.h"

namespace innermap {
namespace {

// Blocks along the longest side of a grid that cannot be shown voxel by voxel.
constexpr int kUsualBlocks = 96, kFewestBlocks = 24;
// What is shown voxel by voxel: so many values of all grids together, in a box of so many voxels,
// and a plane of so many. More makes the page slow to load.
constexpr double kMostValues = 3e6, kMostBox = 3e6, kMostPlane = 2.5e5;
constexpr double kFrameValues = 1.2e6;  // of the grids of all frames together
constexpr std::size_t kMostFrames = 160;
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

float component(float value, int) { return value; }
float component(double value, int) { return static_cast<float>(value); }
float component(std::int32_t value, int) { return static_cast<float>(value); }
float component(std::int64_t value, int) { return static_cast<float>(value); }
float component(bool value, int) { return value ? 1.0f : 0.0f; }
template <class T>
float component(const openvdb::math::Vec3<T>& value, int axis) {
  return static_cast<float>(value[axis]);
}

// Mean, or least, of what falls into each block.
class Blocks {
 public:
  Blocks(PageGrid& grid, const openvdb::Coord& from, bool least)
      : grid_(grid), from_(from), least_(least) {
    const std::size_t count =
        static_cast<std::size_t>(grid.blocks[0]) * grid.blocks[1] * grid.blocks[2];
    sums_.assign(count, 0.0f);
    counts_.assign(count, 0);
    grid.least = std::numeric_limits<double>::infinity();
    grid.greatest = -grid.least;
  }

  // A tile counts once in each block that it meets.
  void add(const openvdb::CoordBBox& box, float value) {
    if (!std::isfinite(value)) return;
    grid_.least = std::min<double>(grid_.least, value);
    grid_.greatest = std::max<double>(grid_.greatest, value);
    std::array<std::int64_t, 3> first{}, last{};
    for (int a = 0; a < 3; ++a) {
      const std::int64_t from = from_[a];
      first[a] = std::max<std::int64_t>(0, (box.min()[a] - from) / grid_.stride);
      last[a] = std::min<std::int64_t>(grid_.blocks[a] - 1, (box.max()[a] - from) / grid_.stride);
    }
    for (std::int64_t z = first[2]; z <= last[2]; ++z)
      for (std::int64_t y = first[1]; y <= last[1]; ++y)
        for (std::int64_t x = first[0]; x <= last[0]; ++x)
          addTo(static_cast<std::size_t>((z * grid_.blocks[1] + y) * grid_.blocks[0] + x), value);
  }

  void finish() {
    for (std::size_t i = 0; i < sums_.size(); ++i)
      if (counts_[i] == 0)
        sums_[i] = kNone;
      else if (!least_)
        sums_[i] /= static_cast<float>(counts_[i]);
    grid_.values = quantised(sums_);
  }

 private:
  void addTo(std::size_t block, float value) {
    if (least_)
      sums_[block] = counts_[block] ? std::min(sums_[block], value) : value;
    else
      sums_[block] += value;
    ++counts_[block];
  }

  PageGrid& grid_;
  openvdb::Coord from_;
  bool least_;
  std::vector<float> sums_;
  std::vector<std::uint32_t> counts_;
};

Vec3 world(const openvdb::math::Transform& transform, const openvdb::Vec3d& index) {
  const openvdb::Vec3d p = transform.indexToWorld(index);
  return {p.x(), p.y(), p.z()};
}

std::int64_t lengthAlong(const openvdb::CoordBBox& box, int axis) {
  return std::int64_t{box.max()[axis]} - box.min()[axis] + 1;
}

std::int64_t blocksAlong(const openvdb::CoordBBox& box, int axis, int stride) {
  return (lengthAlong(box, axis) + stride - 1) / stride;
}

// Grids of one lattice are cut into alike blocks and along the same planes.
struct Lattice {
  openvdb::CoordBBox box;  // of all voxels
  double values = 0;       // of all voxels
  int stride = 1;
};

int strideOf(const Lattice& lattice, const std::optional<PageFrame>& frame) {
  double longest = 1, volume = 1;
  for (int a = 0; a < 3; ++a) {
    const auto length = static_cast<double>(lengthAlong(lattice.box, a));
    longest = std::max(longest, length);
    volume *= length;
  }
  const auto strideFor = [](double of, double most) { return std::max(1.0, std::cbrt(of / most)); };
  double stride = std::min(longest / kUsualBlocks, std::max(strideFor(lattice.values, kMostValues),
                                                            strideFor(volume, kMostBox)));
  if (frame) {
    const std::size_t shown = frame->of / frameStep(frame->of);
    const auto frames = static_cast<double>(shown);
    stride = std::min(
        longest / kFewestBlocks,
        std::max(longest / kUsualBlocks, strideFor(lattice.values, kFrameValues / frames)));
  }
  return std::max(1, static_cast<int>(std::ceil(stride)));
}

// That of a grid among others.
Lattice latticeOf(const openvdb::GridBase& grid, const openvdb::GridPtrVec& grids,
                  const std::optional<PageFrame>& frame) {
  Lattice out;
  for (const openvdb::GridBase::Ptr& other : grids) {
    if (other->transform() != grid.transform() || other->activeVoxelCount() == 0) continue;
    out.box.expand(other->evalActiveVoxelBoundingBox());
    out.values += static_cast<double>(other->activeVoxelCount()) *
                  (other->valueType().compare(0, 3, "vec") == 0 ? 3 : 1);
  }
  if (!out.box.empty()) out.stride = strideOf(out, frame);
  return out;
}

// Sizes and places for blocks in a box of voxels.
void place(PageGrid& out, const openvdb::math::Transform& transform, const openvdb::CoordBBox& box,
           int stride) {
  out.stride = stride;
  const openvdb::Vec3d corner = box.min().asVec3d() - openvdb::Vec3d(0.5);
  out.origin = world(transform, corner);
  for (int a = 0; a < 3; ++a) {
    out.blocks[a] = static_cast<int>(blocksAlong(box, a, stride));
    openvdb::Vec3d next = corner;
    next[a] += stride;
    out.axes[a] = world(transform, next) - out.origin;
  }
}

// Folds are single voxels, which a mean would hide.
bool byLeast(const std::string& name) { return name.find("jacobian") != std::string::npos; }

// Values stand in a skin around the solid too, which is none of the map's.
const openvdb::FloatGrid* surfaceAmong(const openvdb::GridPtrVec& grids) {
  for (const openvdb::GridBase::Ptr& grid : grids)
    if (grid->getName() == "surface" && grid->getGridClass() == openvdb::GRID_LEVEL_SET &&
        grid->isType<openvdb::FloatGrid>())
      return static_cast<const openvdb::FloatGrid*>(grid.get());
  return nullptr;
}

// One component of a grid's values, without those outside of the surface where there is one.
template <class Grid>
class Cutter {
 public:
  Cutter(const Grid& grid, const openvdb::FloatGrid* surface, int axis) : grid_(grid), axis_(axis) {
    if (surface && static_cast<const openvdb::GridBase*>(surface) != &grid &&
        surface->transform() == grid.transform())
      distance_.emplace(surface->getConstAccessor());
  }

  PageGrid blocks(const openvdb::CoordBBox& box, int stride) {
    PageGrid out = framed(box, stride);
    Blocks blocks(out, box.min(), byLeast(grid_.getName()));
    openvdb::CoordBBox where;
    for (auto value = grid_.cbeginValueOn(); value; ++value) {
      if (isOutside(value.getCoord())) continue;
      value.getBoundingBox(where);
      blocks.add(where, component(*value, axis_));
    }
    blocks.finish();
    return out;
  }

  // Each voxel of a box, which is a plane.
  PageGrid voxels(const openvdb::CoordBBox& box) {
    PageGrid out = framed(box, 1);
    Blocks blocks(out, box.min(), true);
    const auto values = grid_.getConstAccessor();
    typename Grid::ValueType value;
    for (auto at = box.beginXYZ(); at; ++at)
      if (values.probeValue(*at, value) && !isOutside(*at))
        blocks.add(openvdb::CoordBBox(*at, *at), component(value, axis_));
    blocks.finish();
    return out;
  }

 private:
  PageGrid framed(const openvdb::CoordBBox& box, int stride) const {
    PageGrid out;
    out.reduction = byLeast(grid_.getName()) ? "least" : "mean";
    place(out, grid_.transform(), box, stride);
    return out;
  }
  bool isOutside(const openvdb::Coord& at) const {
    return distance_ && distance_->getValue(at) >= 0;
  }

  const Grid& grid_;
  int axis_;
  std::optional<openvdb::FloatGrid::ConstAccessor> distance_;
};

// The planes through the middle of the lattice, where blocks would not show each voxel of them.
// Each is as wide as the blocks of this box.
template <class Grid>
std::vector<PageGrid> middlePlanes(Cutter<Grid>& cutter, const Lattice& lattice,
                                   openvdb::CoordBBox box) {
  std::vector<PageGrid> out;
  if (lattice.stride == 1) return out;
  std::array<double, 3> lengths{};
  for (int a = 0; a < 3; ++a)
    lengths[a] = static_cast<double>(blocksAlong(box, a, lattice.stride)) * lattice.stride;
  for (int a = 0; a < 3; ++a) {
    if (lengths[(a + 1) % 3] * lengths[(a + 2) % 3] > kMostPlane) continue;
    openvdb::CoordBBox plane = box;
    for (const int b : {(a + 1) % 3, (a + 2) % 3})
      plane.max()[b] = static_cast<int>(
          std::min<std::int64_t>(std::numeric_limits<int>::max(),
                                 plane.min()[b] + static_cast<std::int64_t>(lengths[b]) - 1));
    plane.min()[a] = plane.max()[a] =
        static_cast<int>((std::int64_t{lattice.box.min()[a]} + lattice.box.max()[a]) / 2);
    out.push_back(cutter.voxels(plane));
    out.back().across = a;
  }
  return out;
}

// surface: leaves out what lies outside of it; may be null.
template <class Grid>
void addGrid(Page& page, const Grid& grid, const openvdb::FloatGrid* surface,
             const Lattice& lattice) {
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  if (box.empty()) return;
  constexpr bool kIsVector = openvdb::VecTraits<typename Grid::ValueType>::IsVec;
  for (int axis = 0; axis < (kIsVector ? 3 : 1); ++axis) {
    Cutter<Grid> cutter(grid, surface, axis);
    PageGrid cut = cutter.blocks(box, lattice.stride);
    if (!(cut.least <= cut.greatest)) continue;
    cut.name = grid.getName() + (kIsVector ? std::string(" ") + "xyz"[axis] : std::string());
    if (page.frame)
      cut.frame = page.frame->number;
    else
      cut.planes = middlePlanes(cutter, lattice, box);
    page.grids.push_back(std::move(cut));
  }
}

}  // namespace

std::size_t frameStep(std::size_t frames) {
  return std::max<std::size_t>(1, (frames + kMostFrames - 1) / kMostFrames);
}

void addGrids(Page& page, const openvdb::GridPtrVec& grids) {
  using Types = openvdb::TypeList<openvdb::FloatGrid, openvdb::DoubleGrid, openvdb::Int32Grid,
                                  openvdb::Int64Grid, openvdb::BoolGrid, openvdb::Vec3SGrid,
                                  openvdb::Vec3DGrid, openvdb::Vec3IGrid>;
  if (page.frame && page.frame->index % frameStep(page.frame->of) != 0) return;
  const openvdb::FloatGrid* const surface = surfaceAmong(grids);
  const std::optional<std::int64_t> frame =
      page.frame ? std::optional(page.frame->number) : std::nullopt;
  for (const openvdb::GridBase::ConstPtr grid : grids) {
    const std::string& name = grid->getName();
    const bool shown = std::any_of(page.grids.begin(), page.grids.end(), [&](const PageGrid& g) {
      return g.frame == frame && (g.name == name || g.name == name + " x");
    });
    if (shown) continue;
    const Lattice lattice = latticeOf(*grid, grids, page.frame);
    if (!grid->apply<Types>([&](const auto& typed) { addGrid(page, typed, surface, lattice); }))
      page.missing.push_back("the grid " + grid->getName() + " is of type " + grid->valueType() +
                             ", which the page does not show");
  }
}

}  // namespace innermap
