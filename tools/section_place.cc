#include "section_place.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace innermap::tool {

int thinnestAxis(const Solid& solid) {
  const Vec3 extent = solid.box().extent();
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

}  // namespace innermap::tool
