#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "report/page/page.h"

namespace innermap {
namespace {

// Blocks along the longest side of a grid.
constexpr int kMostBlocks = 96, kFewestBlocks = 24;
// Of the grids of all frames together, so that the page stays of reasonable size.
constexpr double kFrameValues = 1.2e6;
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
    sums_.assign(count, 0.0);
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
    std::vector<float> values(sums_.size());
    for (std::size_t i = 0; i < sums_.size(); ++i)
      values[i] =
          counts_[i] == 0 ? kNone : static_cast<float>(least_ ? sums_[i] : sums_[i] / counts_[i]);
    grid_.values = quantised(values);
  }

 private:
  void addTo(std::size_t block, float value) {
    if (least_)
      sums_[block] = counts_[block] ? std::min<double>(sums_[block], value) : value;
    else
      sums_[block] += value;
    ++counts_[block];
  }

  PageGrid& grid_;
  openvdb::Coord from_;
  bool least_;
  std::vector<double> sums_;
  std::vector<std::uint32_t> counts_;
};

Vec3 world(const openvdb::math::Transform& transform, const openvdb::Vec3d& index) {
  const openvdb::Vec3d p = transform.indexToWorld(index);
  return {p.x(), p.y(), p.z()};
}

// Of a page of frames, each with so many values a block.
int blocksAlong(std::int64_t longest, std::uint64_t voxels, std::size_t frames,
                std::size_t values) {
  const double each = kFrameValues / static_cast<double>(frames * values);
  const double across = static_cast<double>(longest) *
                        std::cbrt(each / static_cast<double>(std::max<std::uint64_t>(voxels, 1)));
  return static_cast<int>(std::clamp<double>(across, kFewestBlocks, kMostBlocks));
}

// Sizes and places for the box of a grid's voxels. values: those of all grids beside it.
PageGrid frameFor(const openvdb::GridBase& grid, const openvdb::CoordBBox& box,
                  const std::optional<PageFrame>& frame, std::size_t values) {
  PageGrid out;
  std::int64_t longest = 1;
  for (int a = 0; a < 3; ++a)
    longest = std::max<std::int64_t>(longest, std::int64_t{box.max()[a]} - box.min()[a] + 1);
  const int most = frame ? blocksAlong(longest, grid.activeVoxelCount(),
                                       frame->of / frameStep(frame->of), values)
                         : kMostBlocks;
  if (frame) out.frame = frame->number;
  out.stride = static_cast<int>((longest + most - 1) / most);
  const openvdb::Vec3d corner = box.min().asVec3d() - openvdb::Vec3d(0.5);
  out.origin = world(grid.transform(), corner);
  for (int a = 0; a < 3; ++a) {
    const std::int64_t length = std::int64_t{box.max()[a]} - box.min()[a] + 1;
    out.blocks[a] = static_cast<int>((length + out.stride - 1) / out.stride);
    openvdb::Vec3d next = corner;
    next[a] += out.stride;
    out.axes[a] = world(grid.transform(), next) - out.origin;
  }
  return out;
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

// surface: leaves out what lies outside of it; may be null.
template <class Grid>
void addGrid(Page& page, const Grid& grid, const openvdb::FloatGrid* surface, std::size_t values) {
  if (surface && (static_cast<const openvdb::GridBase*>(surface) == &grid ||
                  surface->transform() != grid.transform()))
    surface = nullptr;

  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  if (box.empty()) return;
  constexpr bool kIsVector = openvdb::VecTraits<typename Grid::ValueType>::IsVec;
  const bool least = byLeast(grid.getName());
  for (int axis = 0; axis < (kIsVector ? 3 : 1); ++axis) {
    PageGrid cut = frameFor(grid, box, page.frame, values);
    cut.name = grid.getName() + (kIsVector ? std::string(" ") + "xyz"[axis] : std::string());
    cut.reduction = least ? "least" : "mean";
    Blocks blocks(cut, box.min(), least);
    openvdb::CoordBBox place;
    std::optional<openvdb::FloatGrid::ConstAccessor> distance;
    if (surface) distance.emplace(surface->getConstAccessor());
    for (auto value = grid.cbeginValueOn(); value; ++value) {
      if (distance && distance->getValue(value.getCoord()) >= 0) continue;
      value.getBoundingBox(place);
      blocks.add(place, component(*value, axis));
    }
    blocks.finish();
    if (cut.least <= cut.greatest) page.grids.push_back(std::move(cut));
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
  std::size_t values = 0;
  for (const openvdb::GridBase::Ptr& grid : grids)
    values += grid->valueType().compare(0, 3, "vec") == 0 ? 3 : 1;
  const std::optional<std::int64_t> frame =
      page.frame ? std::optional(page.frame->number) : std::nullopt;
  for (const openvdb::GridBase::ConstPtr grid : grids) {
    const std::string& name = grid->getName();
    const bool shown = std::any_of(page.grids.begin(), page.grids.end(), [&](const PageGrid& g) {
      return g.frame == frame && (g.name == name || g.name == name + " x");
    });
    if (shown) continue;
    if (!grid->apply<Types>([&](const auto& typed) { addGrid(page, typed, surface, values); }))
      page.missing.push_back("the grid " + grid->getName() + " is of type " + grid->valueType() +
                             ", which the page does not show");
  }
}

}  // namespace innermap
