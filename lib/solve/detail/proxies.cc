#include "solve/detail/proxies.h"

#include <cblas.h>

#include "innermap/core/run.h"
#include "solve/detail/blocked_qr.h"
#include "solve/detail/kernel_simd.h"

namespace innermap {

Proxies::Proxies(const ChargeTree& charges, std::shared_ptr<const ExpansionBasis> basis)
    : charges_(charges),
      basis_(std::move(basis)),
      slot_(balls().nodes().size(), kNone),
      packed_(charges.groups()) {
  for (std::size_t n = 0; n < slot_.size(); ++n)
    if (balls().nodes()[n].count() > basis_->pointCount()) slot_[n] = slots_++;
  build();
}

// From the deepest level up.
void Proxies::build() {
  const auto& nodes = balls().nodes();
  std::vector<std::size_t> levels;  // first node of each depth: nodes stand by depth
  for (std::size_t n = 0; n < nodes.size(); ++n)
    if (nodes[n].depth == levels.size()) levels.push_back(n);
  levels.push_back(nodes.size());
  for (std::size_t g = 0; g < packed_.size(); ++g)
    packed_[g].resize(slots_ * basis_->pointCount() * (3 + width(g)));
  const SingleThreadedBlas guard;
  for (std::size_t level = levels.size() - 1; level-- > 0;)
    parallelBlocks(levels[level + 1] - levels[level], 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = levels[level] + begin; n < levels[level] + end; ++n)
        for (std::size_t g = 0; has(n) && g < packed_.size(); ++g) buildNode(n, g);
    });
}

ChargeSpan Proxies::of(std::size_t node, std::size_t group) const {
  const std::size_t numbers = basis_->pointCount() * (3 + width(group));
  return {packed_[group].data() + slot_[node] * numbers, basis_->pointCount()};
}

ChargeSpan Proxies::standIn(std::size_t node, std::size_t group) const {
  return has(node) ? of(node, group) : charges_.charges(balls().nodes()[node], group);
}

void Proxies::addMoments(const ChargeSpan& part, const Ball& ball, std::size_t width,
                         double* moments) const {
  const std::size_t rows = simd::padded(part.count), stride = 3 + width,
                    functions = basis_->harmonics().count();
  std::vector<double> x(rows), y(rows), z(rows), weights(rows * width), h(rows * functions);
  for (std::size_t i = 0; i < part.count; ++i) {
    const double* q = part.first + i * stride;
    x[i] = (q[0] - ball.center.x) / ball.radius;
    y[i] = (q[1] - ball.center.y) / ball.radius;
    z[i] = (q[2] - ball.center.z) / ball.radius;
    for (std::size_t k = 0; k < width; ++k) weights[k * rows + i] = q[3 + k];
  }
  basis_->harmonics().fill(x.data(), y.data(), z.data(), part.count, h.data(), rows);
  cblas_dgemm(CblasColMajor, CblasTrans, CblasNoTrans, static_cast<int>(functions),
              static_cast<int>(width), static_cast<int>(part.count), 1, h.data(),
              static_cast<int>(rows), weights.data(), static_cast<int>(rows), 1, moments,
              static_cast<int>(basis_->paddedCount()));
}

void Proxies::buildNode(std::size_t node, std::size_t group) {
  const BallTree::Node& parent = balls().nodes()[node];
  const std::size_t channels = width(group), stride = 3 + channels, count = basis_->pointCount();
  std::vector<double> moments(3 * basis_->paddedCount(), 0.0), weights(3 * count, 0.0);
  for (std::size_t c = 0; c < parent.children; ++c)
    addMoments(standIn(parent.firstChild + c, group), parent.ball, channels, moments.data());
  if (parent.leaf())
    addMoments(charges_.charges(parent, group), parent.ball, channels, moments.data());
  basis_->proxyWeights(moments.data(), weights.data());
  double* out = packed_[group].data() + slot_[node] * count * stride;
  for (std::size_t i = 0; i < count; ++i, out += stride) {
    for (int a = 0; a < 3; ++a)
      out[a] = parent.ball.center[a] + parent.ball.radius * basis_->points()[i][a];
    for (std::size_t k = 0; k < channels; ++k) out[3 + k] = weights[k * count + i];
  }
}

}  // namespace innermap
