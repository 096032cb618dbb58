#include <algorithm>
#include <array>
#include <cmath>

#include "evaluate/topology.h"
#include "innermap/core/error.h"
#include "transfer/detail/carrier.h"
#include "transfer/detail/continue_values.h"
#include "transfer/detail/sampling.h"

namespace innermap {
namespace {

// Row and column of the six parts in the order xx, yy, zz, xy, yz, xz.
constexpr std::array<std::array<int, 2>, 6> kTensorParts{
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}}};

Mat3 movedTensor(const Mat3& s, const Mat3& a, bool stress) {
  if (!stress) {
    const Mat3 back = inverse(a);
    return product(transposed(back), product(s, back));
  }
  Mat3 out = product(a, product(s, transposed(a)));
  const double det = std::max(std::abs(determinant(a)), kLeastDeterminant);
  for (auto& row : out)
    for (double& x : row) x /= det;
  return out;
}

// Parts: six float grids, or three Vec3 grids.
template <class Grid>
class TensorCarrier : public Carrier {
 public:
  TensorCarrier(std::vector<typename Grid::ConstPtr> parts, std::vector<std::size_t> places,
                bool stress, Sampling sampling)
      : Carrier(std::move(places)),
        parts_(std::move(parts)),
        stress_(stress),
        sampling_(sampling) {}

  openvdb::GridPtrVec makeOutput(const openvdb::MaskGrid& region) const override {
    openvdb::GridPtrVec out;
    for (const auto& part : parts_) out.push_back(emptyLike(*part, region));
    return out;
  }

  void carry(const openvdb::Coord& origin, const Site* sites, const openvdb::FloatGrid&,
             const openvdb::GridPtrVec& output) const override {
    std::vector<PointwiseSampler<Grid>> samplers;
    std::vector<typename Grid::TreeType::LeafNodeType*> leaves;
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      samplers.emplace_back(*parts_[k], sampling_);
      leaves.push_back(static_cast<Grid&>(*output[k]).tree().probeLeaf(origin));
    }
    for (auto voxel = leaves[0]->cbeginValueOn(); voxel; ++voxel, ++sites) {
      Mat3 tensor;
      for (std::size_t k = 0; k < parts_.size(); ++k)
        read(samplers[k].at(sites->inside), k, tensor);
      tensor = movedTensor(tensor, sites->derivative, stress_);
      for (std::size_t k = 0; k < parts_.size(); ++k)
        leaves[k]->setValueOnly(voxel.pos(), part(tensor, k));
    }
  }

 private:
  using Value = typename Grid::ValueType;

  static void read(const Value& value, std::size_t k, Mat3& tensor) {
    if constexpr (kIsVector<Value>) {
      for (int c = 0; c < 3; ++c) tensor[k][c] = value[c];
    } else {
      const auto [r, c] = kTensorParts[k];
      tensor[r][c] = tensor[c][r] = value;
    }
  }

  static Value part(const Mat3& tensor, std::size_t k) {
    if constexpr (kIsVector<Value>) {
      return Value(openvdb::Vec3d(tensor[k][0], tensor[k][1], tensor[k][2]));
    } else {
      return static_cast<Value>(tensor[kTensorParts[k][0]][kTensorParts[k][1]]);
    }
  }

  std::vector<typename Grid::ConstPtr> parts_;
  bool stress_;
  Sampling sampling_;
};

template <class Grid>
std::unique_ptr<Carrier> carrierOf(const openvdb::GridPtrVec& parts,
                                   std::vector<std::size_t> places, bool stress, Sampling sampling,
                                   const openvdb::FloatGrid* solid) {
  std::vector<typename Grid::ConstPtr> typed;
  for (const openvdb::GridBase::Ptr& part : parts) {
    const auto grid = openvdb::gridConstPtrCast<Grid>(part);
    if (!grid)
      throw DataError("grid \"" + part->getName() + "\": is of another type (" + part->type() +
                      ") than the other parts of its tensor, " + Grid::gridType());
    typed.push_back(
        solid ? openvdb::gridPtrCast<Grid>(continuedBeyond(*grid, *solid, kContinuedLayers))
              : grid);
  }
  return std::make_unique<TensorCarrier<Grid>>(std::move(typed), std::move(places), stress,
                                               sampling);
}

}  // namespace

std::unique_ptr<Carrier> makeTensorCarrier(const openvdb::GridPtrVec& parts,
                                           std::vector<std::size_t> places, bool stress,
                                           Sampling sampling, const openvdb::FloatGrid* solid) {
  if (parts.front()->isType<openvdb::FloatGrid>())
    return carrierOf<openvdb::FloatGrid>(parts, std::move(places), stress, sampling, solid);
  if (parts.front()->isType<openvdb::DoubleGrid>())
    return carrierOf<openvdb::DoubleGrid>(parts, std::move(places), stress, sampling, solid);
  if (parts.front()->isType<openvdb::Vec3DGrid>())
    return carrierOf<openvdb::Vec3DGrid>(parts, std::move(places), stress, sampling, solid);
  return carrierOf<openvdb::Vec3SGrid>(parts, std::move(places), stress, sampling, solid);
}

}  // namespace innermap
