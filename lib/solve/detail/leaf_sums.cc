#include "solve/detail/leaf_sums.h"

#include <algorithm>
#include <numeric>

#include "solve/detail/expansion_simd.h"

namespace innermap {
namespace {

constexpr double kTooNear = 0.03;  // of the ball's radius

bool none(const NearCharges& near) {
  return std::all_of(near.begin(), near.end(), [](const auto& n) { return n.empty(); });
}

}  // namespace

void LeafSums::start(std::size_t stride, std::size_t groups, bool gradients) {
  stride_ = stride;
  values_.assign(3 * groups * stride, 0.0);
  gradients_.assign(gradients ? 9 * groups * stride : 0, 0.0);
}

void LeafSums::setTargets(std::size_t count) {
  places_.resize(count);
  for (auto* c : {&x_, &y_, &z_}) c->assign(simd::padded(count), 0.0);
}

void LeafSums::setPoints(const Points& points, const std::uint32_t* order, std::size_t count,
                         const Vec3& center) {
  setTargets(count);
  std::iota(places_.begin(), places_.end(), std::uint16_t{0});
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const Vec3 p = points[order[std::min(i, count - 1)]] - center;
    x_[i] = p.x;
    y_[i] = p.y;
    z_[i] = p.z;
  }
}

void LeafSums::atPoints(const FarField& field, const Points& points, const std::uint32_t* order,
                        std::size_t count, const Expansion& expansion, const NearCharges& near,
                        bool gradients) {
  start(simd::padded(count), near.size(), gradients);
  setPoints(points, order, count, expansion.ball.center);
  addPolynomial(field, expansion);
  addNear(field, near, expansion.ball.radius);
}

void LeafSums::addPolynomial(const FarField& field, const Expansion& expansion) {
  if (expansion.coefficients.empty()) return;
  const ExpansionBasis& basis = field.basis();
  const std::size_t functions = basis.harmonics().count(), padding = basis.paddedCount();
  const double inverse = 1 / expansion.ball.radius,
               slope = inverse * field.sources().charges().inverseScale();
  scaledX_ = x_;
  scaledY_ = y_;
  scaledZ_ = z_;
  for (auto* c : {&scaledX_, &scaledY_, &scaledZ_})
    for (double& v : *c) v *= inverse;
  harmonics_.resize(stride_ * functions);
  basis.harmonics().fill(scaledX_.data(), scaledY_.data(), scaledZ_.data(), places_.size(),
                         harmonics_.data(), stride_);
  std::vector<double> derivative(3 * padding);
  for (std::size_t g = 0; g < field.sources().groups(); ++g) {
    const double* coefficients = expansion.coefficients.data() + 3 * padding * g;
    simd::multiplyThree(harmonics_.data(), stride_, functions, coefficients, padding,
                        values_.data() + 3 * g * stride_);
    for (std::size_t axis = 0; !gradients_.empty() && axis < 3; ++axis) {
      for (std::size_t k = 0; k < 3; ++k)
        basis.harmonics().derivative(static_cast<int>(axis), coefficients + k * padding,
                                     derivative.data() + k * padding);
      sums_.assign(3 * stride_, 0.0);
      simd::multiplyThree(harmonics_.data(), stride_, functions, derivative.data(), padding,
                          sums_.data());
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t i = 0; i < stride_; ++i)
          gradients_[(9 * g + 3 * k + axis) * stride_ + i] += slope * sums_[k * stride_ + i];
    }
  }
}

void LeafSums::addNear(const FarField& field, const NearCharges& near, double radius) {
  const std::size_t count = places_.size(), stride = x_.size();
  const double slope = field.sources().charges().inverseScale();
  if (none(near)) return;
  sums_.resize(3 * stride);
  slopes_.resize(gradients_.empty() ? 0 : 9 * stride);
  for (std::size_t g = 0; g < near.size(); ++g) {
    const std::size_t width = field.sources().width(g);
    const auto sum = [&](simd::Rounding rounding) {
      return simd::sumCharges(near[g].data(), near[g].size() / (3 + width), static_cast<int>(width),
                              x_.data(), y_.data(), z_.data(), count, stride, sums_.data(),
                              slopes_.empty() ? nullptr : slopes_.data(), rounding);
    };
    // Single precision sees coordinates of about the radius: near pairs would lose their digits.
    const double nearest = sum(field.rounding());
    if (field.rounding() == simd::Rounding::single && !(nearest * kTooNear * radius < 1))
      sum(simd::Rounding::rough);
    for (std::size_t k = 0; k < width; ++k)
      for (std::size_t i = 0; i < count; ++i)
        values_[(3 * g + k) * stride_ + places_[i]] += sums_[k * stride + i];
    for (std::size_t k = 0; !slopes_.empty() && k < 3 * width; ++k)
      for (std::size_t i = 0; i < count; ++i)
        gradients_[(9 * g + k) * stride_ + places_[i]] += slope * slopes_[k * stride + i];
  }
}

void LeafSums::atBlock(const FarField& field, const LatticeBlock& polynomial,
                       const std::array<std::uint64_t, 8>& wanted, double spacing,
                       const Expansion& expansion, const NearCharges& near, bool gradients) {
  constexpr std::size_t kPoints = LatticeBlock::kPoints;
  const std::size_t padding = field.basis().paddedCount();
  start(kPoints, near.size(), gradients);
  for (std::size_t g = 0; g < near.size() && !expansion.coefficients.empty(); ++g)
    polynomial.evaluate(expansion.coefficients.data() + 3 * padding * g, padding,
                        field.sources().charges().inverseScale() / expansion.ball.radius,
                        values_.data() + 3 * kPoints * g,
                        gradients ? gradients_.data() + 9 * kPoints * g : nullptr);
  if (none(near)) return;
  std::size_t count = 0;
  for (const std::uint64_t word : wanted)
    count += static_cast<std::size_t>(__builtin_popcountll(word));
  if (count == 0) return;
  setTargets(count);
  std::size_t at = 0;
  for (std::size_t i = 0; i < kPoints; ++i)
    if (wanted[i >> 6] >> (i & 63) & 1) places_[at++] = static_cast<std::uint16_t>(i);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const int p = places_[std::min(i, count - 1)];
    x_[i] = spacing * ((p >> 6) - 3.5);
    y_[i] = spacing * ((p >> 3 & 7) - 3.5);
    z_[i] = spacing * ((p & 7) - 3.5);
  }
  addNear(field, near, expansion.ball.radius);
}

}  // namespace innermap
