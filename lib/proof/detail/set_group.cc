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
// So many charges are expanded about the whole group first.
constexpr std::size_t kWorthExpanding = 16;

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

ExpansionBall ballAbout(const LaneSets& sets) {
  Box3 box;
  for (std::size_t lane = 0; lane < kLanes; ++lane) box.add(centerOf(sets, lane));
  ExpansionBall out{box.center(), 0};
  for (std::size_t lane = 0; lane < kLanes; ++lane)
    out.radius = std::max(out.radius, norm(centerOf(sets, lane) - out.center) + sets.radius[lane]);
  out.radius *= 1 + 1e-12;
  return out;
}

}  // namespace

// False where nothing is known of any lane that is needed.
bool SetGroup::computeStep(const FieldTree& tree, LaneSets& sets, std::uint8_t needed,
                           LaneFindings& out) {
  fillUnused(sets, needed);
  const ExpansionBall ball = ballAbout(sets);
  const StepExpansion& node = tree.about(ball.center, ball.radius);
  // Nodes of the tree are up to three times as large as the group, so that most of what is near a
  // node is far from the group: it is expanded about it once, not about each set.
  sortCharges(tree.charges(), node.near, ball, tree.orderLimits(), places_, far_);
  const bool pays = far_.count() >= kWorthExpanding;
  const std::uint32_t* const near = far_.list.data() + (pays ? far_.count() : 0);
  const std::size_t count = far_.list.size() - (pays ? far_.count() : 0);
  nearest_.resize(count);
  const std::uint8_t known = measure(tree.charges(), near, count, sets, nearest_.data());
  if ((known & needed) == 0) return false;
  Remainder cut;
  int order = worthyOrder(node, ball, cut);
  if (pays) {
    expandAbout(tree.charges(), node, order, far_, ball, own_);
    order = worthyOrder(own_, ball, cut);
  }
  const StepExpansion& from = pays ? own_ : node;
  LaneRemainders remainder{};
  addInherited(from, cut, sets, remainder);
  moveExpansion(from, order, sets, coefficients_.data());
  places_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t place = orderPlace(tree.orderLimits(), nearest_[i]);
    places_[i] = place == kNotExpanded ? 0 : place;
  }
  arrange(near, places_, near_);
  addCharges(tree.charges(), near_, sets, coefficients_.data(), remainder);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    remainder.gradientMagnitude[lane] *= tree.rounding();
    remainder.valueMagnitude[lane] *= tree.rounding();
  }
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
