#include "io/volume/detail/volume_sampler.h"

#include <Imath/half.h>
#include <OpenEXR/ImfPixelType.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "evaluate/topology.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

constexpr int kMostPointsASide = 16;

template <class Value>
constexpr int componentsOf() {
  return openvdb::VecTraits<Value>::IsVec ? 3 : 1;
}

template <class Value>
double component(const Value& value, int c) {
  if constexpr (openvdb::VecTraits<Value>::IsVec)
    return static_cast<double>(value[c]);
  else
    return static_cast<double>(value);
}

// Puts values into the floats of a row.
template <class Value>
class Store {
 public:
  using Element = typename openvdb::VecTraits<Value>::ElementType;

  explicit Store(PixelType type)
      : type_(type), most_(type == PixelType::half ? 65504.0 : std::numeric_limits<float>::max()) {}

  void put(double value, double& pixel, PixelCounts& counts) const {
    pixel = value;
    if (type_ == PixelType::number) return;
    pixel = pixelValue(value, type_ == PixelType::half);
    if (std::abs(value) > most_ && std::isfinite(value)) ++counts.clamped;
    if constexpr (std::is_integral_v<Element> && !std::is_same_v<Element, bool>)
      if (pixel != value) ++counts.inexact;
  }

 private:
  PixelType type_;
  double most_;
};

// Voxels along an axis with their shares in a mean of linearly interpolated values; the shares of a
// box are the products.
struct AxisWeights {
  int count = 0;
  std::array<int, 2 * kMostPointsASide> index;
  std::array<double, 2 * kMostPointsASide> weight;

  int last() const { return index[count - 1]; }

  // Points ascend: an index is one of the last two or new.
  void add(int i, double share) {
    if (share == 0) return;
    for (int k = count - 1; k >= std::max(0, count - 2); --k)
      if (index[k] == i) {
        weight[k] += share;
        return;
      }
    index[count] = i;
    weight[count++] = share;
  }
};

template <class Grid>
class CopySampler : public VolumeSampler {
 public:
  using Value = typename Grid::ValueType;

  CopySampler(const Grid& grid, PixelType pixel) : grid_(grid), store_(pixel) {}

  PixelCounts row(const VolumeLattice& lattice, int slice, int row, double* const* outputs,
                  double* active) const override {
    PixelCounts counts;
    const auto accessor = grid_.getConstUnsafeAccessor();
    openvdb::Coord at = lattice.coord(0, row, slice);
    for (int i = 0; i < lattice.width(); ++i, ++at[lattice.columnAxis]) {
      const Value value = accessor.getValue(at);
      for (int c = 0; c < componentsOf<Value>(); ++c)
        store_.put(component(value, c), outputs[c][i], counts);
      if (active) active[i] = accessor.isValueOn(at) ? 1 : 0;
    }
    return counts;
  }

 private:
  const Grid& grid_;
  Store<Value> store_;
};

template <class Grid>
class PointSampler : public VolumeSampler {
 public:
  using Value = typename Grid::ValueType;
  static constexpr int kComponents = componentsOf<Value>();
  static constexpr bool kInterpolates =
      std::is_floating_point_v<typename openvdb::VecTraits<Value>::ElementType>;

  PointSampler(const Grid& grid, const VolumeResampling& resampling, PixelType pixel)
      : grid_(grid), resampling_(resampling), store_(pixel) {
    const bool one = !kInterpolates || grid.getGridClass() == openvdb::GRID_LEVEL_SET;
    const double side = std::ceil(resampling.scale - 1e-6);
    points_ = one ? 1 : static_cast<int>(std::clamp(side, 1.0, double(kMostPointsASide)));
  }

  PixelCounts row(const VolumeLattice& lattice, int slice, int row, double* const* outputs,
                  double* active) const override {
    PixelCounts counts;
    const auto accessor = grid_.getConstUnsafeAccessor();
    openvdb::Coord at = lattice.coord(0, row, slice);
    for (int i = 0; i < lattice.width(); ++i, ++at[lattice.columnAxis]) {
      double sums[3] = {0, 0, 0};
      const bool on = sample(accessor, at.asVec3d(), sums);
      for (int c = 0; c < kComponents; ++c) store_.put(sums[c], outputs[c][i], counts);
      if (active) active[i] = on ? 1 : 0;
    }
    return counts;
  }

 private:
  // The mean over the points in the lattice voxel about `at`; whether a voxel that it is made of is
  // active.
  template <class Accessor>
  bool sample(const Accessor& accessor, const openvdb::Vec3d& at, double* sums) const {
    const openvdb::Vec3d middle = resampling_.scale * at + resampling_.offset;
    const AxisWeights x = weightsAbout(middle.x()), y = weightsAbout(middle.y()),
                      z = weightsAbout(middle.z());
    bool on = false;
    if (uniform(accessor, x, y, z)) {
      const openvdb::Coord first(x.index[0], y.index[0], z.index[0]);
      const Value value = accessor.getValue(first);
      for (int c = 0; c < kComponents; ++c) sums[c] = component(value, c);
      return accessor.isValueOn(first);
    }
    for (int i = 0; i < x.count; ++i)
      for (int j = 0; j < y.count; ++j)
        for (int k = 0; k < z.count; ++k) {
          Value value;
          on = accessor.probeValue({x.index[i], y.index[j], z.index[k]}, value) || on;
          const double weight = x.weight[i] * y.weight[j] * z.weight[k];
          for (int c = 0; c < kComponents; ++c) sums[c] += weight * component(value, c);
        }
    return on;
  }

  AxisWeights weightsAbout(double middle) const {
    AxisWeights weights;
    if constexpr (!kInterpolates) {
      weights.add(static_cast<int>(std::lround(middle)), 1);
      return weights;
    }
    for (int k = 0; k < points_; ++k) {
      const double p = middle + resampling_.scale * ((k + 0.5) / points_ - 0.5);
      const double floor = std::floor(p);
      weights.add(static_cast<int>(floor), (1 - (p - floor)) / points_);
      weights.add(static_cast<int>(floor) + 1, (p - floor) / points_);
    }
    return weights;
  }

  // Whether all voxels of the box lie in tiles of one value and state: most of space does.
  template <class Accessor>
  static bool uniform(const Accessor& accessor, const AxisWeights& x, const AxisWeights& y,
                      const AxisWeights& z) {
    constexpr int kLeaf = 8;  // tiles are no smaller
    const openvdb::Coord from(x.index[0], y.index[0], z.index[0]);
    const openvdb::Coord to(x.last(), y.last(), z.last());
    const Value value = accessor.getValue(from);
    const bool on = accessor.isValueOn(from);
    const auto next = [](int i) { return (i & ~(kLeaf - 1)) + kLeaf; };
    openvdb::Coord at = from;
    for (at.x() = from.x(); at.x() <= to.x(); at.x() = next(at.x()))
      for (at.y() = from.y(); at.y() <= to.y(); at.y() = next(at.y()))
        for (at.z() = from.z(); at.z() <= to.z(); at.z() = next(at.z()))
          if (accessor.isVoxel(at) || accessor.isValueOn(at) != on ||
              !(accessor.getValue(at) == value))
            return false;
    return true;
  }

  const Grid& grid_;
  VolumeResampling resampling_;
  Store<Value> store_;
  int points_ = 1;
};

}  // namespace

float pixelValue(double value, bool asHalf) {
  if (!std::isfinite(value)) return static_cast<float>(value);
  if (asHalf) return half(static_cast<float>(std::clamp(value, -65504.0, 65504.0)));
  constexpr double kMost = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(value, -kMost, kMost));
}

std::unique_ptr<VolumeSampler> makeVolumeSampler(const openvdb::GridBase& grid,
                                                 const VolumeResampling& resampling,
                                                 PixelType pixel) {
  std::unique_ptr<VolumeSampler> sampler;
  grid.apply<GridTypes>([&](const auto& typed) {
    using Grid = std::decay_t<decltype(typed)>;
    if (resampling.copies)
      sampler = std::make_unique<CopySampler<Grid>>(typed, pixel);
    else
      sampler = std::make_unique<PointSampler<Grid>>(typed, resampling, pixel);
  });
  if (!sampler)
    throw DataError(fmt::format("grid '{}' has the type {}, which has no numbers for a texture",
                                grid.getName(), grid.valueType()));
  return sampler;
}

}  // namespace innermap
