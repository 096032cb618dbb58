#include "proof/detail/set_group.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace innermap::proof {
namespace {

// Below 1, so that the bound of the determinant, (1 - S)^3 of that at the centre, is not empty: it
// costs one cell in a hundred.
constexpr double kProven = 0.8;
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

GroupBall ballAbout(const LaneSets& sets) {
  Box3 box;
  for (std::size_t lane = 0; lane < kLanes; ++lane) box.add(centerOf(sets, lane));
  GroupBall out{box.center(), 0};
  for (std::size_t lane = 0; lane < kLanes; ++lane)
    out.radius = std::max(out.radius, norm(centerOf(sets, lane) - out.center) + sets.radius[lane]);
  out.radius *= 1 + 1e-12;
  return out;
}

// All eight centres in one place.
LaneSets oneSet(const GroupBall& ball) {
  LaneSets out{};
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    for (int a = 0; a < 3; ++a) out.center[a][lane] = ball.center[a];
    out.radius[lane] = ball.radius;
  }
  return out;
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

// Nodes of the tree are up to three times as large as the group, so that most of what is near a
// node is far from the group: it is expanded about it once, not about each set.
void SetGroup::expandAbout(const FieldTree& tree, const StepExpansion& from,
                           const GroupBall& ball) {
  const LaneSets one = oneSet(ball);
  LaneRemainders added, none;
  far_.resize(farOfOwn_.size());
  classify(tree.charges(), farOfOwn_.data(), farOfOwn_.size(), one, tree.farRatio(), far_.data(),
           added, none);
  add(added, none);
  addInherited(from, one, added);
  moveExpansion(from, one, coefficients_.data());
  own_.center = ball.center;
  own_.coefficients.resize(kCoefficients);
  for (std::size_t i = 0; i < kCoefficients; ++i) own_.coefficients[i] = coefficients_[i * kLanes];
  own_.remainder = {added.gradient[0], added.value[0], added.gradientMagnitude[0],
                    added.valueMagnitude[0]};
  addCharges(tree.charges(), farOfOwn_.data(), farOfOwn_.size(), own_);
}

// Whether it pays to expand about the group what is near the node and far from the group.
bool SetGroup::sortCharges(const FieldTree& tree, const StepExpansion& from,
                           const GroupBall& ball) {
  own_.near.clear();
  farOfOwn_.clear();
  const double far = ball.radius / tree.farRatio() * (1 + 1e-12);
  for (const std::uint32_t j : from.near) {
    const double* q = tree.charges() + kChargeStride * j;
    const bool isFar = squaredNorm(Vec3{q[0], q[1], q[2]} - ball.center) > far * far;
    (isFar ? farOfOwn_ : own_.near).push_back(j);
  }
  return farOfOwn_.size() >= 2 * kLanes;
}

// False where nothing is known of any lane that is needed.
bool SetGroup::computeStep(const FieldTree& tree, LaneSets& sets, std::uint8_t needed,
                           LaneFindings& out) {
  fillUnused(sets, needed);
  const GroupBall ball = ballAbout(sets);
  const StepExpansion& node = tree.about(ball.center, ball.radius);
  const bool pays = sortCharges(tree, node, ball);
  const StepExpansion& from = pays ? own_ : node;
  const std::size_t count = from.near.size();
  far_.resize(count);
  LaneRemainders remainder, near;
  classify(tree.charges(), from.near.data(), count, sets, tree.farRatio(), far_.data(), remainder,
           near);
  if (!(lanesBelow(near.gradient, std::numeric_limits<double>::infinity()) & needed)) return false;
  if (pays) expandAbout(tree, node, ball);
  addInherited(from, sets, remainder);
  add(remainder, near);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    remainder.gradientMagnitude[lane] *= tree.rounding();
    remainder.valueMagnitude[lane] *= tree.rounding();
  }
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
  std::fill(std::begin(excess_), std::end(excess_), std::numeric_limits<double>::infinity());
  std::uint8_t proven = alive, known = alive;
  LaneSets now = sets;
  for (std::size_t k = 0; k < map.count(); ++k) {
    known = evenLanes(now, senses ? known & proven : known);
    if (known == 0 || !computeStep(map[k], now, known, findings_[k])) return;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      double excess = findings_[k].excess[lane];
      if (std::isnan(excess)) excess = std::numeric_limits<double>::infinity();  // cells are sorted
      if (known >> lane & 1) excess_[lane] = k == 0 ? excess : std::max(excess_[lane], excess);
    }
    proven &= known & lanesBelow(findings_[k].excess, kProven);
    now = findings_[k].image;
    known &= finiteLanes(now);
  }
  enclosed_ = known;
  proven_ = proven;
}

}  // namespace innermap::proof
