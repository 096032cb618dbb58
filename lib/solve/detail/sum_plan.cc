#include "solve/detail/sum_plan.h"

#include <algorithm>
#include <cmath>

namespace innermap {
namespace {

// In units of one pair of the plain sum without gradients; measured on two cores with AVX-512.
constexpr double kGradients = 2;
constexpr double kUpward = 40;        // a charge, for each harmonic
constexpr double kFarCharges = 20;    // of a ball, for each of its check points
constexpr double kTranslation = 3;    // a check point, for each harmonic
constexpr double kEvaluation = 0.25;  // a point, for each harmonic
constexpr double kNear = 150;         // charges
constexpr double kCheap = 2e9;        // plain pairs that take a second or two

}  // namespace

// The error is about kError * separation^(order + 1) of the magnitudes, whether charges cancel
// (fitted ones, to a 500th) or not: 484 sums of a map in steps had 1e-4 to 5e-4 in the median, nine
// of ten below 1e-3. High orders are dear: their translations cost the fourth power, while near
// charges grow with the inverse square of the separation. So both go with the accuracy.
FarFieldPlan planFor(double accuracy) {
  // Of the magnitudes, too: sums in single precision lost 6e-9 to 1.9e-8 (12,000 to 52,500 fitted
  // charges), those with a rough square root at most 1e-10.
  constexpr double kError = 6e-4, kSingle = 4e-8, kRough = 3e-10;
  FarFieldPlan plan;
  const double digits = -std::log10(accuracy);
  plan.separation = std::clamp(0.5 - 0.05 * (digits - 5.3), 0.3, 0.5);
  const double order = std::log(accuracy / kError) / std::log(plan.separation) - 1;
  plan.order = static_cast<int>(
      std::ceil(std::clamp<double>(order, kLeastOrder, ExpansionBasis::kMostOrder)));
  plan.rounding = accuracy >= kSingle  ? simd::Rounding::single
                  : accuracy >= kRough ? simd::Rounding::rough
                                       : simd::Rounding::full;
  return plan;
}

// Rounding may be what was missing, too.
FarFieldPlan raised(FarFieldPlan plan, double excess) {
  const double missing = std::log(1.5 * excess) / -std::log(plan.separation);
  plan.order += std::isfinite(missing) ? std::clamp(static_cast<int>(std::ceil(missing)), 1, 8) : 8;
  plan.rounding =
      plan.rounding == simd::Rounding::single ? simd::Rounding::rough : simd::Rounding::full;
  return plan;
}

bool plainIsCheap(const SumSize& size) {
  return (size.gradients ? kGradients : 1) * static_cast<double>(size.charges) *
             static_cast<double>(size.points) <=
         kCheap;
}

bool hierarchyIsCheaper(const SumSize& size) {
  const double charges = static_cast<double>(size.charges),
               points = static_cast<double>(size.points),
               leaves = points / static_cast<double>(size.pointsPerLeaf) + 1,
               harmonics = (size.order + 1.0) * (size.order + 1.0),
               slope = size.gradients ? kGradients : 1;
  const double far =
      leaves * harmonics * (std::min(charges, kFarCharges * harmonics) + kTranslation * harmonics);
  const double evaluation =
      points * (slope * std::min(charges, kNear) + 2 * slope * kEvaluation * harmonics);
  const double upward = charges * harmonics * kUpward;
  return far + evaluation + upward < slope * charges * points;
}

}  // namespace innermap
