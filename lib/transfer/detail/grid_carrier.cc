#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tools/ValueTransformer.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <cmath>

#include "evaluate/topology.h"
#include "innermap/core/error.h"
#include "levelset/set_metadata.h"
#include "transfer/detail/carrier.h"
#include "transfer/detail/continue_values.h"
#include "transfer/detail/sampling.h"
#include "transfer/moved_vector.h"

namespace innermap {
namespace {

bool isAttribute(const openvdb::GridBase& grid, bool density) {
  return !density && grid.getGridClass() != openvdb::GRID_LEVEL_SET &&
         grid.getGridClass() != openvdb::GRID_FOG_VOLUME;
}

// Where a level set is the surface of the solid that it lives in, to a voxel, it becomes that of
// the other solid. Where the map crushes, its error is many voxels of the source; carried as it is,
// the surface would be as ragged.
class OwnSurface {
 public:
  template <class Grid>
  OwnSurface(const openvdb::FloatGrid& solid, const Grid& levelSet)
      : solid_(solid),
        voxel_(levelSet.voxelSize()[0]),
        band_(std::min(static_cast<double>(solid.background()),
                       static_cast<double>(levelSet.background()))) {}

  class Sampler {
   public:
    explicit Sampler(const OwnSurface& own) : own_(own), solid_(own.solid_, Sampling::linear) {}

    // value: of the level set at the site. distance: from the other solid's surface, world units.
    double replaced(double value, const Site& site, double distance) const {
      const double same = own_.sameness(value, static_cast<double>(solid_.at(site.at)));
      if (!(same > 0)) return value;
      const double grown =
          std::cbrt(std::max(std::abs(determinant(site.derivative)), kLeastDeterminant));
      return (1 - same) * value + same * distance / grown;
    }

   private:
    const OwnSurface& own_;
    const PointwiseSampler<openvdb::FloatGrid> solid_;
  };

 private:
  // 1 up to a voxel of the grid apart, 0 from two on; beyond their bands only signs count.
  double sameness(double value, double own) const {
    const double apart = std::clamp(value, -band_, band_) - std::clamp(own, -band_, band_);
    return std::clamp(2 - std::abs(apart) / voxel_, 0.0, 1.0);
  }

  const openvdb::FloatGrid& solid_;
  double voxel_, band_;
};

template <class Grid>
class GridCarrier : public Carrier {
 public:
  using Value = typename Grid::ValueType;
  using Leaf = typename Grid::TreeType::LeafNodeType;

  GridCarrier(typename Grid::ConstPtr grid, std::size_t place, Sampling sampling,
              std::optional<double> densityLimit, const openvdb::FloatGrid* solid)
      : Carrier({place}),
        grid_(std::move(grid)),
        sampling_(sampling),
        densityLimit_(densityLimit),
        attribute_(isAttribute(*grid_, densityLimit.has_value())) {
    if constexpr (std::is_floating_point_v<Value>)
      if (solid && grid_->getGridClass() == openvdb::GRID_LEVEL_SET)
        ownSurface_.emplace(*solid, *grid_);
  }

  openvdb::GridPtrVec makeOutput(const openvdb::MaskGrid& region) const override {
    const openvdb::GridBase::Ptr out = emptyLike(*grid_, region);
    // Sampled at voxel centres, a staggered grid is none any more.
    if (out->getGridClass() == openvdb::GRID_STAGGERED) out->setGridClass(openvdb::GRID_UNKNOWN);
    return {out};
  }

  void carry(const openvdb::Coord& origin, const Site* sites, const openvdb::FloatGrid& to,
             const openvdb::GridPtrVec& output) const override {
    if constexpr (std::is_floating_point_v<Value>)
      if (ownSurface_) return carryLevelSet(origin, sites, to, output);
    const PointwiseSampler<Grid> sampler(*grid_, sampling_);
    const openvdb::VecType type = grid_->getVectorType();
    Leaf& leaf = *static_cast<Grid&>(*output[0]).tree().probeLeaf(origin);
    for (auto voxel = leaf.beginValueOn(); voxel; ++voxel, ++sites)
      voxel.setValue(
          moved(sampler.at(attribute_ ? sites->inside : sites->at), sites->derivative, type));
  }

  openvdb::GridBase* positions(const openvdb::GridPtrVec& output) const override {
    return kIsVector<Value> && grid_->getVectorType() == openvdb::VEC_CONTRAVARIANT_ABSOLUTE
               ? output[0].get()
               : nullptr;
  }

  bool isDensity() const override { return densityLimit_.has_value(); }

  void finish(openvdb::GridPtrVec& output) const override {
    if constexpr (std::is_floating_point_v<Value>)
      if (grid_->getGridClass() == openvdb::GRID_LEVEL_SET) output[0] = rebuilt(output[0]);
  }

 private:
  Value moved(const Value& value, const Mat3& a, openvdb::VecType type) const {
    if constexpr (std::is_floating_point_v<Value>) {
      if (densityLimit_)
        return static_cast<Value>(
            value / std::max({std::abs(determinant(a)), 1 / *densityLimit_, kLeastDeterminant}));
    } else if constexpr (kIsVector<Value> && !kIsDiscrete<Value>) {
      const Vec3 v = movedVector({value[0], value[1], value[2]}, a, type);
      return Value(openvdb::Vec3d(v.x, v.y, v.z));
    }
    return value;
  }

  void carryLevelSet(const openvdb::Coord& origin, const Site* sites, const openvdb::FloatGrid& to,
                     const openvdb::GridPtrVec& output) const {
    const PointwiseSampler<Grid> sampler(*grid_, sampling_);
    const OwnSurface::Sampler own(*ownSurface_);
    const auto distances = to.getConstAccessor();
    Leaf& leaf = *static_cast<Grid&>(*output[0]).tree().probeLeaf(origin);
    for (auto voxel = leaf.beginValueOn(); voxel; ++voxel, ++sites) {
      const double distance = static_cast<double>(distances.getValue(voxel.getCoord()));
      voxel.setValue(static_cast<Value>(own.replaced(sampler.at(sites->at), *sites, distance)));
    }
  }

  openvdb::GridBase::Ptr rebuilt(const openvdb::GridBase::Ptr& sampled) const {
    const auto& in = static_cast<const Grid&>(*sampled);
    const double width =
        std::max(3.0, static_cast<double>(grid_->background()) / grid_->voxelSize()[0]);
    typename Grid::Ptr out = bandOf(in, static_cast<float>(width));
    for (auto meta = in.beginMeta(); meta != in.endMeta(); ++meta)
      setMetadata(*out, meta->first, *meta->second);
    out->setGridClass(openvdb::GRID_LEVEL_SET);
    return out;
  }

  // Distances from where the values change their sign, in a band of so many voxels to each side.
  // Signs are those of the values: levelSetRebuild fills all that cannot be reached from outside.
  static typename Grid::Ptr bandOf(const Grid& sampled, float width) {
    // In index space, where floats are exact enough far from the origin too.
    const typename Grid::ConstPtr indexed =
        Grid::create(std::const_pointer_cast<typename Grid::TreeType>(sampled.treePtr()));
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(*indexed, points, triangles, quads);
    const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec4I> mesh(points,
                                                                                          quads);
    typename Grid::Ptr out = openvdb::tools::meshToVolume<Grid>(
        mesh, sampled.transform(), width, width, openvdb::tools::UNSIGNED_DISTANCE_FIELD);
    openvdb::tools::foreach (out->beginValueOn(), [&sampled](const auto& voxel) {
      if (sampled.getConstUnsafeAccessor().getValue(voxel.getCoord()) < 0) voxel.setValue(-*voxel);
    });
    openvdb::tools::signedFloodFill(out->tree());
    return out;
  }

  typename Grid::ConstPtr grid_;
  Sampling sampling_;
  std::optional<double> densityLimit_;
  bool attribute_;
  std::optional<OwnSurface> ownSurface_;  // of level sets, where the solid is known
};

// A mask's values are its active voxels.
template <>
class GridCarrier<openvdb::MaskGrid> : public Carrier {
 public:
  GridCarrier(openvdb::MaskGrid::ConstPtr grid, std::size_t place, Sampling, std::optional<double>,
              const openvdb::FloatGrid*)
      : Carrier({place}), grid_(std::move(grid)) {}

  openvdb::GridPtrVec makeOutput(const openvdb::MaskGrid& region) const override {
    return {emptyLike(*grid_, region)};
  }

  void carry(const openvdb::Coord& origin, const Site* sites, const openvdb::FloatGrid&,
             const openvdb::GridPtrVec& output) const override {
    auto input = grid_->getConstAccessor();
    auto& leaf = *static_cast<openvdb::MaskGrid&>(*output[0]).tree().probeLeaf(origin);
    const auto region = leaf.getValueMask();
    for (auto voxel = region.beginOn(); voxel; ++voxel, ++sites) {
      const openvdb::Vec3d p(sites->at.x, sites->at.y, sites->at.z);
      leaf.setActiveState(voxel.pos(),
                          input.isValueOn(grid_->transform().worldToIndexNodeCentered(p)));
    }
  }

 private:
  openvdb::MaskGrid::ConstPtr grid_;
};

template <class Grid>
std::unique_ptr<Carrier> carrierOf(const openvdb::GridBase::Ptr& grid, std::size_t place,
                                   Sampling sampling, std::optional<double> densityLimit,
                                   const openvdb::FloatGrid* solid) {
  typename Grid::ConstPtr typed = openvdb::gridConstPtrCast<Grid>(grid);
  if constexpr (!std::is_same_v<Grid, openvdb::MaskGrid>)
    if (solid && isAttribute(*grid, densityLimit.has_value()))
      typed = openvdb::gridPtrCast<Grid>(continuedBeyond(*grid, *solid, kContinuedLayers));
  return std::make_unique<GridCarrier<Grid>>(typed, place, sampling, densityLimit, solid);
}

}  // namespace

std::unique_ptr<Carrier> makeGridCarrier(const openvdb::GridBase::Ptr& grid, std::size_t place,
                                         Sampling sampling, std::optional<double> densityLimit,
                                         const openvdb::FloatGrid* solid) {
  using Make = std::unique_ptr<Carrier> (*)(const openvdb::GridBase::Ptr&, std::size_t, Sampling,
                                            std::optional<double>, const openvdb::FloatGrid*);
  const std::pair<std::string, Make> makers[] = {
      {openvdb::FloatGrid::gridType(), carrierOf<openvdb::FloatGrid>},
      {openvdb::DoubleGrid::gridType(), carrierOf<openvdb::DoubleGrid>},
      {openvdb::Int32Grid::gridType(), carrierOf<openvdb::Int32Grid>},
      {openvdb::Int64Grid::gridType(), carrierOf<openvdb::Int64Grid>},
      {openvdb::BoolGrid::gridType(), carrierOf<openvdb::BoolGrid>},
      {openvdb::Vec3SGrid::gridType(), carrierOf<openvdb::Vec3SGrid>},
      {openvdb::Vec3DGrid::gridType(), carrierOf<openvdb::Vec3DGrid>},
      {openvdb::Vec3IGrid::gridType(), carrierOf<openvdb::Vec3IGrid>},
      {openvdb::MaskGrid::gridType(), carrierOf<openvdb::MaskGrid>}};
  for (const auto& [type, make] : makers)
    if (grid->type() == type) return make(grid, place, sampling, densityLimit, solid);
  throw DataError("grid \"" + grid->getName() + "\": has the type " + grid->type() +
                  ", which cannot be carried; choose others with --grids");
}

}  // namespace innermap
