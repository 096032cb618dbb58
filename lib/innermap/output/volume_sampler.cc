#include "innermap/output/volume_sampler.h"

#include <Imath/half.h>
#include <OpenEXR/ImfPixelType.h>
#include <fmt/format.h>
#include <openvdb/tools/Interpolation.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

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

  explicit Store(bool asHalf)
      : half_(asHalf), most_(asHalf ? 65504.0 : std::numeric_limits<float>::max()) {}

  void put(double value, float& pixel, PixelCounts& counts) const {
    pixel = pixelValue(value, half_);
    if (std::abs(value) > most_ && std::isfinite(value)) ++counts.clamped;
    if constexpr (std::is_integral_v<Element> && !std::is_same_v<Element, bool>)
      if (static_cast<double>(pixel) != value) ++counts.inexact;
  }

 private:
  bool half_;
  double most_;
};

template <class Grid>
class CopySampler : public VolumeSampler {
 public:
  using Value = typename Grid::ValueType;

  CopySampler(const Grid& grid, bool asHalf) : grid_(grid), store_(asHalf) {}

  PixelCounts row(const VolumeLattice& lattice, int slice, int row, float* const* outputs,
                  float* active) const override {
    PixelCounts counts;
    const auto accessor = grid_.getConstUnsafeAccessor();
    openvdb::Coord at = lattice.coord(0, row, slice);
    for (int i = 0; i < lattice.width(); ++i, ++at[lattice.columnAxis]) {
      const Value value = accessor.getValue(at);
      for (int c = 0; c < componentsOf<Value>(); ++c)
        store_.put(component(value, c), outputs[c][i], counts);
      if (active) active[i] = accessor.isValueOn(at) ? 1.0f : 0.0f;
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

  PointSampler(const Grid& grid, const VolumeResampling& resampling, bool asHalf)
      : grid_(grid), resampling_(resampling), store_(asHalf) {
    const bool one = !kInterpolates || grid.getGridClass() == openvdb::GRID_LEVEL_SET;
    const double side = std::ceil(resampling.scale - 1e-6);
    points_ = one ? 1 : static_cast<int>(std::clamp(side, 1.0, double(kMostPointsASide)));
  }

  PixelCounts row(const VolumeLattice& lattice, int slice, int row, float* const* outputs,
                  float* active) const override {
    PixelCounts counts;
    const auto accessor = grid_.getConstUnsafeAccessor();
    openvdb::Coord at = lattice.coord(0, row, slice);
    for (int i = 0; i < lattice.width(); ++i, ++at[lattice.columnAxis]) {
      double sums[3] = {0, 0, 0};
      const bool on = sample(accessor, at.asVec3d(), sums);
      for (int c = 0; c < kComponents; ++c) store_.put(sums[c], outputs[c][i], counts);
      if (active) active[i] = on ? 1.0f : 0.0f;
    }
    return counts;
  }

 private:
  // The mean over the points in the lattice voxel about `at`; whether any of them is active.
  template <class Accessor>
  bool sample(const Accessor& accessor, const openvdb::Vec3d& at, double* sums) const {
    bool on = false;
    const auto place = [&](int k) { return (k + 0.5) / points_ - 0.5; };
    for (int x = 0; x < points_; ++x)
      for (int y = 0; y < points_; ++y)
        for (int z = 0; z < points_; ++z) {
          const openvdb::Vec3d p = at + openvdb::Vec3d(place(x), place(y), place(z));
          on = atPoint(accessor, resampling_.scale * p + resampling_.offset, sums) || on;
        }
    if (points_ > 1)
      for (int c = 0; c < kComponents; ++c) sums[c] /= double(points_) * points_ * points_;
    return on;
  }

  template <class Accessor>
  bool atPoint(const Accessor& accessor, const openvdb::Vec3d& p, double* sums) const {
    if constexpr (kInterpolates) {
      Value value;
      const bool on = openvdb::tools::BoxSampler::sample(accessor, p, value);
      for (int c = 0; c < kComponents; ++c) sums[c] += component(value, c);
      return on;
    } else {
      const openvdb::Coord nearest = openvdb::Coord::round(p);
      for (int c = 0; c < kComponents; ++c) sums[c] += component(accessor.getValue(nearest), c);
      return accessor.isValueOn(nearest);
    }
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
                                                 const VolumeResampling& resampling, bool asHalf) {
  using Types = openvdb::TypeList<openvdb::FloatGrid, openvdb::DoubleGrid, openvdb::Int32Grid,
                                  openvdb::Int64Grid, openvdb::BoolGrid, openvdb::MaskGrid,
                                  openvdb::Vec3SGrid, openvdb::Vec3DGrid, openvdb::Vec3IGrid>;
  std::unique_ptr<VolumeSampler> sampler;
  grid.apply<Types>([&](const auto& typed) {
    using Grid = std::decay_t<decltype(typed)>;
    if (resampling.copies)
      sampler = std::make_unique<CopySampler<Grid>>(typed, asHalf);
    else
      sampler = std::make_unique<PointSampler<Grid>>(typed, resampling, asHalf);
  });
  if (!sampler)
    throw DataError(fmt::format("grid '{}' has the type {}, which has no numbers for a texture",
                                grid.getName(), grid.valueType()));
  return sampler;
}

}  // namespace innermap
