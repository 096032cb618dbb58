#include "proof/detail/set_group.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace innermap::proof {
namespace {

// S has to stay below 1 by more than the rounding of its own sum.
constexpr double kProven = 1 - 1e-9;
// Sets this much larger than the smallest of their group are left to be split.
constexpr double kMostUneven = 8;

Vec3 centerOf(const LaneSets& sets, std::size_t lane) {
  return {sets.center[0][lane], sets.center[1][lane], sets.center[2][lane]};
}

// Lanes that do not matter take the place of one that does: they must not trouble the others.
void fillUnused(LaneSets& sets, std::uint8_t used) {
  int from = 0;
  while (!(used >> from & 1)) ++from;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (used >> lane & 1) continue;
    for (Lanes& c : sets.center) c[lane] = c[from];
    for (auto& vertex : sets.vertex)
      for (Lanes& v : vertex) v[lane] = v[from];
    sets.slack[lane] = sets.slack[from];
    sets.radius[lane] = sets.radius[from];
  }
}

std::uint8_t finiteLanes(const LaneSets& sets) {
  unsigned out = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    double sum = sets.radius[lane];
    for (const Lanes& c : sets.center) sum += std::abs(c[lane]);
    if (std::isfinite(sum)) out |= 1u << lane;
  }
  return static_cast<std::uint8_t>(out);
}

std::uint8_t lanesBelow(const Lanes& values, double bound) {
  unsigned out = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane)
    if (values[lane] < bound) out |= 1u << lane;  // not so for NaN
  return static_cast<std::uint8_t>(out);
}

// Of these lanes those that are not much larger than the smallest.
std::uint8_t evenLanes(const LaneSets& sets, std::uint8_t lanes) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t lane = 0; lane < kLanes; ++lane)
    if (lanes >> lane & 1) least = std::min(least, sets.radius[lane]);
  return lanes & lanesBelow(sets.radius, kMostUneven * least);
}

// The smallest expansion that holds on all sets.
const StepExpansion& expansionAbout(const FieldTree& tree, const LaneSets& sets) {
  Box3 box;
  for (std::size_t lane = 0; lane < kLanes; ++lane) box.add(centerOf(sets, lane));
  const Vec3 center = box.center();
  double radius = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane)
    radius = std::max(radius, norm(centerOf(sets, lane) - center) + sets.radius[lane]);
  return tree.about(center, radius);
}

void add(LaneRemainders& a, const LaneRemainders& b) {
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    a.gradient[lane] += b.gradient[lane];
    a.value[lane] += b.value[lane];
    a.gradientMagnitude[lane] += b.gradientMagnitude[lane];
    a.valueMagnitude[lane] += b.valueMagnitude[lane];
  }
}

}  // namespace

StepTrees::StepTrees(const ComposedMap& map, double scale) {
  for (const HarmonicMap& step : map.steps()) trees_.emplace_back(step.field(), scale);
}

// False where nothing is known of any lane that is needed.
bool SetGroup::computeStep(const FieldTree& tree, LaneSets& sets, std::uint8_t needed,
                           LaneFindings& out) {
  fillUnused(sets, needed);
  const StepExpansion& from = expansionAbout(tree, sets);
  const std::size_t count = from.near.size();
  far_.resize(count);
  LaneRemainders remainder, near;
  classify(tree.charges(), from.near.data(), count, sets, far_.data(), remainder, near);
  if (!(lanesBelow(near.gradient, std::numeric_limits<double>::infinity()) & needed)) return false;
  addInherited(from, sets, remainder);
  add(remainder, near);
  moveExpansion(from, sets, coefficients_.data());
  far_.assign(count, 0xff);
  addCharges(tree.charges(), from.near.data(), far_.data(), 0, count, sets, coefficients_.data());
  examine(coefficients_.data(), remainder, sets, out);
  return true;
}

void SetGroup::compute(const StepTrees& map, const LaneSets& sets, std::uint8_t alive,
                       bool senses) {
  findings_.resize(map.count());
  proven_ = enclosed_ = 0;
  std::uint8_t proven = alive, known = alive;
  LaneSets now = sets;
  for (std::size_t k = 0; k < map.count(); ++k) {
    known = evenLanes(now, senses ? known & proven : known);
    if (known == 0 || !computeStep(map[k], now, known, findings_[k])) return;
    proven &= known & lanesBelow(findings_[k].excess, kProven);
    now = findings_[k].image;
    known &= finiteLanes(now);
  }
  enclosed_ = known;
  proven_ = proven;
}

}  // namespace innermap::proof
