#include "io/volume/detail/dense_types.h"

#include <cmath>
#include <cstring>
#include <limits>

namespace innermap {
namespace {

template <class T>
void put(double value, char* to) {
  T stored{};
  if constexpr (std::is_integral_v<T>) {
    // The type's ends are no doubles: what rounds beyond them is them.
    if (value >= static_cast<double>(std::numeric_limits<T>::max()))
      stored = std::numeric_limits<T>::max();
    else if (value <= static_cast<double>(std::numeric_limits<T>::min()))
      stored = std::numeric_limits<T>::min();
    else if (!std::isnan(value))
      stored = static_cast<T>(std::llround(value));
  } else {
    stored = static_cast<T>(value);
  }
  std::memcpy(to, &stored, sizeof(T));
}

constexpr DenseType kFloat{"Float32", 16, 4, put<float>}, kDouble{"Float64", 64, 8, put<double>},
    kInt32{"Int32", 8, 4, put<std::int32_t>}, kInt64{"Int64", 1024, 8, put<std::int64_t>},
    kByte{"UInt8", 2, 1, put<std::uint8_t>};

}  // namespace

const DenseType& denseType(const std::string& gridType) {
  if (gridType == "double" || gridType == "vec3d") return kDouble;
  if (gridType == "int32" || gridType == "vec3i") return kInt32;
  if (gridType == "int64") return kInt64;
  if (gridType == "bool" || gridType == "mask") return kByte;
  return kFloat;
}

VolumePlan makeDensePlan(const openvdb::GridPtrVec& grids, const VolumeTextureSettings& settings) {
  VolumeTextureSettings dense = settings;
  dense.layout = VolumeLayout::parts;  // no tiles
  dense.channels = VolumeChannels::layers;
  return makeExactPlan(grids, dense);
}

VolumeTextureResult denseResult(const std::string& path, const VolumePlan& plan) {
  VolumeTextureResult result;
  result.files = {path};
  for (const VolumeGrid& grid : plan.grids) result.channels.push_back(grid.name);
  result.resolution = plan.lattice.size;
  result.worldBox = plan.lattice.worldBox();
  return result;
}

}  // namespace innermap
