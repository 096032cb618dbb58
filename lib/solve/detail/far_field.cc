#include "solve/detail/far_field.h"

#include <algorithm>

#include "solve/detail/expansion_simd.h"

namespace innermap {
namespace {

void append(const ChargeSpan& span, std::size_t stride, const Vec3& center,
            std::vector<double>& to) {
  const std::size_t begin = to.size();
  to.insert(to.end(), span.first, span.first + span.count * stride);
  for (std::size_t i = begin; i < to.size(); i += stride) {
    to[i] -= center.x;
    to[i + 1] -= center.y;
    to[i + 2] -= center.z;
  }
}

}  // namespace

FarField::FarField(const Proxies& proxies, const FarFieldPlan& plan)
    : proxies_(proxies), plan_(plan), basis_(proxies.basis()) {
  const std::size_t size = simd::padded(basis_->pointCount());
  x_.resize(size);
  y_.resize(size);
  z_.resize(size);
  for (std::size_t i = 0; i < basis_->pointCount(); ++i) {
    x_[i] = basis_->points()[i].x;
    y_[i] = basis_->points()[i].y;
    z_[i] = basis_->points()[i].z;
  }
}

// Charges of a leaf one by one.
void FarField::split(const BallTree::Node& leaf, const Ball& ball, NearCharges& near,
                     NearCharges& far) const {
  const double reach = ball.radius / plan_.separation, squared = reach * reach;
  for (std::size_t g = 0; g < proxies_.groups(); ++g) {
    const std::size_t stride = 3 + proxies_.width(g);
    const ChargeSpan span = proxies_.charges().charges(leaf, g);
    for (std::size_t i = 0; i < span.count; ++i) {
      const double* q = span.first + i * stride;
      const bool isFar = squaredNorm(Vec3{q[0], q[1], q[2]} - ball.center) >= squared;
      append({q, 1}, stride, ball.center, isFar ? far[g] : near[g]);
    }
  }
}

// Into work.far what is far, the rest into `left` (nodes) or, without that, into `near`.
void FarField::gather(const Ball& ball, const std::vector<std::uint32_t>& nodes,
                      std::vector<std::uint32_t>* left, NearCharges* near,
                      FarFieldWorkspace& work) const {
  const auto& all = proxies_.balls().nodes();
  const double reach = ball.radius / plan_.separation;
  work.far.resize(proxies_.groups());
  for (auto& f : work.far) f.clear();
  work.stack = nodes;
  while (!work.stack.empty()) {
    const std::uint32_t n = work.stack.back();
    work.stack.pop_back();
    const BallTree::Node& node = all[n];
    const double distance = norm(node.ball.center - ball.center);
    const bool far = distance - node.ball.radius >= reach,
               together = !proxies_.has(n) ||
                          node.ball.radius <= plan_.separation * (distance - ball.radius);
    if (far && together) {
      for (std::size_t g = 0; g < proxies_.groups(); ++g)
        append(proxies_.standIn(n, g), 3 + proxies_.width(g), ball.center, work.far[g]);
      continue;
    }
    if (left && (node.leaf() || (!far && node.ball.radius <= ball.radius))) {
      left->push_back(n);
      continue;
    }
    if (node.leaf()) {
      split(node, ball, *near, work.far);
      continue;
    }
    for (std::size_t c = 0; c < node.children; ++c) work.stack.push_back(node.firstChild + c);
  }
}

Expansion FarField::expand(const Ball& ball, const Expansion& parent,
                           const std::vector<std::uint32_t>& nodes,
                           std::vector<std::uint32_t>& left, FarFieldWorkspace& work) const {
  gather(ball, nodes, &left, nullptr, work);
  return expansionOf(ball, parent, work);
}

Expansion FarField::expandLast(const Ball& ball, const Expansion& parent,
                               const std::vector<std::uint32_t>& nodes, NearCharges& near,
                               FarFieldWorkspace& work) const {
  near.resize(proxies_.groups());
  for (auto& n : near) n.clear();
  gather(ball, nodes, nullptr, &near, work);
  return expansionOf(ball, parent, work);
}

Expansion FarField::expansionOf(const Ball& ball, const Expansion& parent,
                                FarFieldWorkspace& work) const {
  Expansion out{ball, {}};
  const bool none =
      std::all_of(work.far.begin(), work.far.end(), [](const auto& f) { return f.empty(); });
  if (none && parent.coefficients.empty()) return out;
  const std::size_t groups = proxies_.groups(), count = basis_->pointCount(),
                    block = 3 * basis_->paddedCount();
  work.values.assign(3 * count * groups, 0.0);
  work.x = x_;
  work.y = y_;
  work.z = z_;
  for (auto* c : {&work.x, &work.y, &work.z})
    for (double& v : *c) v *= ball.radius;
  for (std::size_t g = 0; g < groups; ++g) {
    const std::size_t width = proxies_.width(g), stride = 3 + width;
    simd::sumCharges(work.far[g].data(), work.far[g].size() / stride, static_cast<int>(width),
                     work.x.data(), work.y.data(), work.z.data(), count, count,
                     work.values.data() + 3 * count * g, nullptr, plan_.rounding);
  }
  if (!parent.coefficients.empty()) addParent(ball, parent, work);
  out.coefficients.assign(block * groups, 0.0);
  for (std::size_t g = 0; g < groups; ++g)
    basis_->coefficients(work.values.data() + 3 * count * g, out.coefficients.data() + block * g);
  return out;
}

void FarField::addParent(const Ball& ball, const Expansion& parent, FarFieldWorkspace& work) const {
  const std::size_t count = basis_->pointCount(), block = 3 * basis_->paddedCount(),
                    functions = basis_->harmonics().count();
  const Vec3 offset = (ball.center - parent.ball.center) / parent.ball.radius;
  const double scale = ball.radius / parent.ball.radius;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    work.x[i] = offset.x + scale * x_[i];
    work.y[i] = offset.y + scale * y_[i];
    work.z[i] = offset.z + scale * z_[i];
  }
  work.harmonics.resize(count * functions);
  basis_->harmonics().fill(work.x.data(), work.y.data(), work.z.data(), count,
                           work.harmonics.data(), count);
  for (std::size_t g = 0; g < proxies_.groups(); ++g)
    simd::multiplyThree(work.harmonics.data(), count, functions,
                        parent.coefficients.data() + block * g, basis_->paddedCount(),
                        work.values.data() + 3 * count * g);
}

}  // namespace innermap
