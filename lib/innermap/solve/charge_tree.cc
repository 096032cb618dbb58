#include "innermap/solve/charge_tree.h"

#include <algorithm>
#include <cmath>

#include "innermap/core/error.h"
#include "innermap/core/parallel.h"
#include "innermap/solve/expansion_simd.h"
#include "innermap/solve/kernel_simd.h"

namespace innermap {
namespace {

// Small, so that few charges are summed directly only because others of their leaf are near.
constexpr std::size_t kLeafSize = 12;
// Balls of coincident charges get this radius (of the whole) so that ratios to it stay finite.
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
      balls_(localPoints(sources, center_, inverseScale_), 0, kLeafSize, 1) {
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

Proxies::Proxies(const ChargeTree& charges, std::shared_ptr<const ExpansionBasis> basis,
                 Progress* progress)
    : charges_(charges),
      basis_(std::move(basis)),
      slot_(charges.balls().nodes().size(), kNone),
      packed_(charges.groups()) {
  const auto& nodes = charges.balls().nodes();
  std::uint32_t slots = 0;
  std::vector<std::uint32_t> levels;  // first node of each depth, nodes standing by depth
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (nodes[n].depth == levels.size()) levels.push_back(static_cast<std::uint32_t>(n));
    if (nodes[n].count() > basis_->pointCount()) slot_[n] = slots++;
  }
  levels.push_back(static_cast<std::uint32_t>(nodes.size()));
  for (std::size_t g = 0; g < packed_.size(); ++g)
    packed_[g].resize(slots * basis_->pointCount() * (3 + charges.width(g)));
  // From the deepest level up: a node is made of what stands for its children.
  for (std::size_t level = levels.size() - 1; level-- > 0;)
    parallelBlocks(
        levels[level + 1] - levels[level], 4,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t n = levels[level] + begin; n < levels[level] + end; ++n)
            for (std::size_t g = 0; has(n) && g < packed_.size(); ++g) build(n, g);
        },
        progress);
}

ChargeSpan Proxies::of(std::size_t node, std::size_t group) const {
  const std::size_t numbers = basis_->pointCount() * (3 + charges_.width(group));
  return {packed_[group].data() + slot_[node] * numbers, basis_->pointCount()};
}

ChargeSpan Proxies::standIn(std::size_t node, std::size_t group) const {
  return has(node) ? of(node, group) : charges_.charges(charges_.balls().nodes()[node], group);
}

// Proxies match all moments up to the order, and those of the parent up to the order need no more
// of its children: passing them up loses nothing.
void Proxies::build(std::size_t node, std::size_t group) {
  const BallTree::Node& parent = charges_.balls().nodes()[node];
  const double radius = std::max(parent.ball.radius, kLeastRadius);
  const std::size_t width = charges_.width(group), stride = 3 + width;
  std::vector<ChargeSpan> parts;
  if (parent.leaf()) parts.push_back(charges_.charges(parent, group));
  for (std::size_t c = 0; c < parent.children; ++c)
    parts.push_back(standIn(parent.firstChild + c, group));
  const std::size_t functions = basis_->harmonics().count(), padded = basis_->paddedCount();
  std::vector<double> moments(3 * padded, 0.0);
  for (const ChargeSpan& part : parts) {
    const std::size_t rows = (part.count + simd::kPadding - 1) / simd::kPadding * simd::kPadding;
    std::vector<double> x(rows), y(rows), z(rows), h(rows * functions);
    for (std::size_t i = 0; i < part.count; ++i) {
      const double* q = part.first + i * stride;
      x[i] = (q[0] - parent.ball.center.x) / radius;
      y[i] = (q[1] - parent.ball.center.y) / radius;
      z[i] = (q[2] - parent.ball.center.z) / radius;
    }
    basis_->harmonics().fill(x.data(), y.data(), z.data(), part.count, h.data(), rows);
    for (std::size_t c = 0; c < functions; ++c)
      for (std::size_t k = 0; k < width; ++k) {
        double sum = 0;
        for (std::size_t i = 0; i < part.count; ++i)
          sum += h[c * rows + i] * part.first[i * stride + 3 + k];
        moments[k * padded + c] += sum;
      }
  }
  const std::size_t count = basis_->pointCount();
  std::vector<double> weights(3 * count, 0.0);
  basis_->proxyWeights(moments.data(), weights.data());
  double* out = packed_[group].data() + slot_[node] * count * stride;
  for (std::size_t i = 0; i < count; ++i, out += stride) {
    for (int a = 0; a < 3; ++a) out[a] = parent.ball.center[a] + radius * basis_->points()[i][a];
    for (std::size_t k = 0; k < width; ++k) out[3 + k] = weights[k * count + i];
  }
}

}  // namespace innermap
