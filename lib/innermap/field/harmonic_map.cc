#include "innermap/field/harmonic_map.h"

#include <string>

#include "innermap/core/error.h"

namespace innermap {

HarmonicMap::HarmonicMap(HarmonicField field) : field_(std::move(field)) {
  if (field_.channels() != 3)
    throw DataError("map: the field has " + std::to_string(field_.channels()) +
                    " channels; a map needs 3, the target's x, y and z");
}

void HarmonicMap::evaluate(const Vec3* points, std::size_t count, Vec3* positions,
                           Mat3* jacobians) const {
  std::vector<double> values(3 * count), gradients(jacobians ? 9 * count : 0);
  field_.evaluate(points, count, values.data(), jacobians ? gradients.data() : nullptr);
  for (std::size_t i = 0; i < count; ++i)
    for (int r = 0; r < 3; ++r) {
      if (positions) positions[i][r] = values[r * count + i];
      for (int a = 0; jacobians && a < 3; ++a)
        jacobians[i][r][a] = gradients[(3 * r + a) * count + i];
    }
}

Vec3 HarmonicMap::operator()(const Vec3& p) const {
  Vec3 q;
  evaluate(&p, 1, &q, nullptr);
  return q;
}

Mat3 HarmonicMap::jacobian(const Vec3& p) const {
  Mat3 j;
  evaluate(&p, 1, nullptr, &j);
  return j;
}

}  // namespace innermap
