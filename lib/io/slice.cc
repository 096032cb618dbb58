#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "evaluate/topology.h"
#include "innermap/core/error.h"
#include "innermap/io/pictures.h"

namespace innermap {
namespace {

constexpr std::int64_t kLongestSide = 65536;

template <class Value>
constexpr int componentsOf() {
  return openvdb::VecTraits<Value>::IsVec ? 3 : 1;
}

template <class Value>
float component(const Value& value, int c) {
  if constexpr (openvdb::VecTraits<Value>::IsVec)
    return static_cast<float>(value[c]);
  else
    return static_cast<float>(value);
}

int componentCount(const openvdb::GridBase& grid) {
  int count = 0;
  const bool known = grid.apply<GridTypes>([&](const auto& typed) {
    count = componentsOf<typename std::decay_t<decltype(typed)>::ValueType>();
  });
  if (!known)
    throw DataError(fmt::format("grid '{}' has the type {}, which has no numbers to show",
                                grid.getName(), grid.valueType()));
  return count;
}

}  // namespace

int parseAxis(const std::string& setting, const std::string& text) {
  static const std::string lower = "xyz", upper = "XYZ";
  for (int axis = 0; axis < 3; ++axis)
    if (text.size() == 1 && (text[0] == lower[axis] || text[0] == upper[axis])) return axis;
  throw SettingError(setting, "'" + text + "' is not one of x, y, z");
}

char axisName(int axis) { return "xyz"[axis]; }

openvdb::Coord SliceFrame::coord(std::size_t column, std::size_t row, int layer) const {
  openvdb::Coord c;
  c[axis] = layer;
  c[columnAxis] = box.min()[columnAxis] + static_cast<int>(column);
  c[rowAxis] = box.max()[rowAxis] - static_cast<int>(row);
  return c;
}

Vec3 SliceFrame::world(std::size_t column, std::size_t row, int layer) const {
  const openvdb::Vec3d w = transform->indexToWorld(coord(column, row, layer));
  return {w.x(), w.y(), w.z()};
}

double SliceFrame::position(double layer) const {
  openvdb::Vec3d index = 0.5 * (box.min().asVec3d() + box.max().asVec3d());
  index[axis] = layer;
  return transform->indexToWorld(index)[axis];
}

double SliceFrame::layerAt(double place) const {
  openvdb::Vec3d world = transform->indexToWorld(0.5 * (box.min().asVec3d() + box.max().asVec3d()));
  world[axis] = place;
  return transform->worldToIndex(world)[axis];
}

SliceFrame sliceFrame(const openvdb::GridPtrVec& grids, int axis) {
  if (grids.empty()) throw DataError("there are no grids to slice");
  SliceFrame frame;
  frame.axis = axis;
  frame.columnAxis = axis == 0 ? 2 : 0;
  frame.rowAxis = axis == 1 ? 2 : 1;
  for (const openvdb::GridBase::Ptr& grid : grids) {
    if (!grid->constTransform().isLinear())
      throw DataError(
          fmt::format("grid '{}' has a frustum transform, which cannot be sliced; "
                      "resample it",
                      grid->getName()));
    if (grid->constTransform() != grids.front()->constTransform())
      throw DataError(
          fmt::format("grids '{}' and '{}' have different transforms; choose grids of "
                      "one transform",
                      grids.front()->getName(), grid->getName()));
    frame.box.expand(grid->evalActiveVoxelBoundingBox());
  }
  if (frame.box.empty()) throw DataError("no grid has an active voxel, so there is no slice");
  for (int a = 0; a < 3; ++a) {
    const std::int64_t side = std::int64_t(frame.box.max()[a]) - frame.box.min()[a] + 1;
    if (side > kLongestSide)
      throw DataError(fmt::format("the active box has {} voxels along {}; at most {} can be sliced",
                                  side, axisName(a), kLongestSide));
  }
  frame.transform = grids.front()->constTransform().copy();
  return frame;
}

std::vector<int> sliceLayers(const SliceFrame& frame, int count) {
  const std::int64_t layers = frame.layers(), parts = std::min<std::int64_t>(count, layers);
  std::vector<int> result;
  for (std::int64_t i = 0; i < parts; ++i)
    result.push_back(frame.box.min()[frame.axis] +
                     static_cast<int>((2 * i + 1) * layers / (2 * parts)));
  return result;
}

int thinnestAxis(const Vec3& extent) {
  int axis = 0;
  for (int a = 1; a < 3; ++a)
    if (extent[a] < extent[axis]) axis = a;
  return axis;
}

double fullLayer(const openvdb::FloatGrid& density, int axis) {
  constexpr double kNearly = 0.9;
  const openvdb::CoordBBox box = density.evalActiveVoxelBoundingBox();
  std::vector<double> filled(static_cast<std::size_t>(std::max(1, box.dim()[axis])), 0.0);
  for (auto value = density.cbeginValueOn(); value; ++value) {
    openvdb::CoordBBox covered;
    value.getBoundingBox(covered);
    const double area = static_cast<double>(covered.volume()) / covered.dim()[axis] * *value;
    for (int i = covered.min()[axis]; i <= covered.max()[axis]; ++i)
      filled[static_cast<std::size_t>(i - box.min()[axis])] += area;
  }
  const double enough = kNearly * *std::max_element(filled.begin(), filled.end());
  double best = 0;
  for (std::size_t i = 0; i < filled.size(); ++i) {
    const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(filled.size());
    if (filled[i] >= enough && std::abs(at - 0.5) < std::abs(best - 0.5)) best = at;
  }
  return best;
}

std::vector<std::string> channelNames(const openvdb::GridBase& grid) {
  const std::string name = grid.getName();
  if (componentCount(grid) == 1) return {name + ".V"};
  const bool colour = name == "Cd" || name == "color";
  std::vector<std::string> names;
  for (const char c : std::string(colour ? "RGB" : "XYZ")) names.push_back(name + "." + c);
  return names;
}

std::vector<SliceChannel> sliceGrid(const openvdb::GridBase& grid, const SliceFrame& frame,
                                    int layer) {
  std::vector<SliceChannel> channels;
  for (const std::string& name : channelNames(grid))
    channels.push_back({name, std::vector<float>(frame.rows() * frame.columns(), 0.0f)});
  const bool everywhere = grid.getGridClass() == openvdb::GRID_LEVEL_SET;
  grid.apply<GridTypes>([&](const auto& typed) {
    using Value = typename std::decay_t<decltype(typed)>::ValueType;
    const auto accessor = typed.getConstAccessor();
    std::size_t i = 0;
    for (std::size_t row = 0; row < frame.rows(); ++row)
      for (std::size_t column = 0; column < frame.columns(); ++column, ++i) {
        const openvdb::Coord at = frame.coord(column, row, layer);
        if (!everywhere && !accessor.isValueOn(at)) continue;
        const Value value = accessor.getValue(at);
        for (int c = 0; c < componentsOf<Value>(); ++c)
          channels[static_cast<std::size_t>(c)].values[i] = component(value, c);
      }
  });
  return channels;
}

std::vector<float> sliceMask(const openvdb::GridPtrVec& grids, const SliceFrame& frame, int layer) {
  std::vector<float> mask(frame.rows() * frame.columns(), 0.0f);
  for (const openvdb::GridBase::Ptr& grid : grids)
    grid->apply<GridTypes>([&](const auto& typed) {
      const auto accessor = typed.getConstAccessor();
      std::size_t i = 0;
      for (std::size_t row = 0; row < frame.rows(); ++row)
        for (std::size_t column = 0; column < frame.columns(); ++column, ++i)
          if (accessor.isValueOn(frame.coord(column, row, layer))) mask[i] = 1;
    });
  return mask;
}

}  // namespace innermap
