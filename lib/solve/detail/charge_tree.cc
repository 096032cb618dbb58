#include "solve/detail/charge_tree.h"

#include <cmath>

#include "innermap/core/error.h"

namespace innermap {
namespace {

// Small, so that few charges are summed directly only because others of their leaf are near.
constexpr std::size_t kLeafSize = 12;
// Balls of coincident charges get this radius, of the whole: ratios to it stay finite.
constexpr double kLeastRadius = 1e-9;

Points localPoints(const Points& sources, const Vec3& center, double inverseScale) {
  Points out(sources.size());
  for (std::size_t i = 0; i < sources.size(); ++i) {
    out[i] = inverseScale * (sources[i] - center);
    if (!isFinite(out[i]))
      throw DataError("charges: source " + std::to_string(i) + " is not finite");
  }
  return out;
}

double inverseOf(double length) { return length > 0 ? 1 / length : 1; }

}  // namespace

ChargeTree::ChargeTree(const Points& sources, const Matrix& weights)
    : center_(sources.empty() ? Vec3{} : boundingBox(sources).center()),
      inverseScale_(inverseOf(boundingBox(sources).diagonal())),
      channels_(weights.columns()),
      balls_(localPoints(sources, center_, inverseScale_), kLeastRadius, kLeafSize, 1) {
  if (weights.rows() != sources.size())
    throw DataError("charges: " + std::to_string(sources.size()) + " sources but " +
                    std::to_string(weights.rows()) + " rows of weights; give one row a source");
  packed_.resize((channels_ + 2) / 3);
  for (std::size_t g = 0; g < packed_.size(); ++g) {
    packed_[g].reserve(sources.size() * (3 + width(g)));
    for (const std::uint32_t j : balls_.order()) {
      const Vec3 q = toLocal(sources[j]);
      packed_[g].insert(packed_[g].end(), {q.x, q.y, q.z});
      for (std::size_t k = 0; k < width(g); ++k) {
        const double w = weights(j, 3 * g + k) * inverseScale_;
        if (!std::isfinite(w))
          throw DataError("charges: weight of source " + std::to_string(j) + " is not finite");
        packed_[g].push_back(w);
      }
    }
  }
}

}  // namespace innermap
