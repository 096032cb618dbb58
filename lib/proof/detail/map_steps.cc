#include "proof/detail/map_steps.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace innermap::proof {
namespace {

// S has to stay below 1 by more than the rounding of its own sum.
constexpr double kProven = 1 - 1e-9;

std::vector<double> packed(const HarmonicField& field, double scale) {
  const Points& sources = field.sources();
  std::vector<double> out(kChargeStride * sources.size());
  for (std::size_t j = 0; j < sources.size(); ++j) {
    double* q = out.data() + kChargeStride * j;
    Vec3 weight;
    for (int k = 0; k < 3; ++k) {
      q[k] = scale * sources[j][k];
      weight[k] = q[3 + k] = scale * scale * field.weights()(j, k);
    }
    q[6] = norm(weight) * (1 + 1e-15);
  }
  return out;
}

StepExpansion affineExpansion(const HarmonicField& field, double scale) {
  const Affine& affine = field.affine();
  StepExpansion out;
  out.center = scale * affine.center;
  out.coefficients.assign(kCoefficients, 0);
  double squares = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double value = scale * affine.coefficients(0, k);
    out.coefficients[6 * termOf(0, 0) + 2 * k] = value;
    out.coefficients[6 * termOf(1, 1) + 2 * k] = affine.coefficients(1, k);
    out.coefficients[6 * termOf(1, 1) + 2 * k + 1] = affine.coefficients(2, k);
    out.coefficients[6 * termOf(1, 0) + 2 * k] = affine.coefficients(3, k);
    for (std::size_t a = 1; a < 4; ++a)
      squares += affine.coefficients(a, k) * affine.coefficients(a, k);
    out.remainder.valueMagnitude += std::abs(value);
  }
  out.remainder.gradientMagnitude = std::sqrt(squares);
  out.near.resize(field.sources().size());
  std::iota(out.near.begin(), out.near.end(), 0u);
  return out;
}

// Lanes that do not matter take the place of one that does: they must not trouble the others.
void fillUnused(LaneSets& sets, std::uint8_t known) {
  int from = 0;
  while (!(known >> from & 1)) ++from;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (known >> lane & 1) continue;
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

void addParent(const StepExpansion& parent, StepGroup& step) {
  LaneRemainders& r = step.remainder;
  const Remainder& p = parent.remainder;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const Vec3 center{step.sets.center[0][lane], step.sets.center[1][lane],
                      step.sets.center[2][lane]};
    r.gradient[lane] += p.gradient;
    r.value[lane] += p.value;
    r.gradientMagnitude[lane] += p.gradientMagnitude;
    r.valueMagnitude[lane] += p.valueMagnitude + norm(center - parent.center) * p.gradientMagnitude;
  }
}

LaneRemainders sum(LaneRemainders a, const LaneRemainders& b) {
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    a.gradient[lane] += b.gradient[lane];
    a.value[lane] += b.value[lane];
    a.gradientMagnitude[lane] += b.gradientMagnitude[lane];
    a.valueMagnitude[lane] += b.valueMagnitude[lane];
  }
  return a;
}

std::uint8_t lanesBelow(const Lanes& values, double bound) {
  unsigned out = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane)
    if (values[lane] < bound) out |= 1u << lane;  // not so for NaN
  return static_cast<std::uint8_t>(out);
}

}  // namespace

MapSteps::MapSteps(const ComposedMap& map, double scale) {
  for (const HarmonicMap& step : map.steps()) {
    charges_.push_back(packed(step.field(), scale));
    start_.push_back(std::make_shared<const StepExpansion>(affineExpansion(step.field(), scale)));
  }
}

// False where nothing is known of any lane that matters.
bool SetGroup::computeStep(const MapSteps& map, const StepExpansions& parent, std::size_t k,
                           GroupUse use, std::uint8_t needed) {
  StepGroup& step = steps_[k];
  const StepExpansion& from = *parent[k];
  const std::size_t count = from.near.size();
  step.far.resize(count);
  step.coefficients.resize(kCoefficients * kLanes);
  LaneRemainders near;
  classify(map.charges(k), from.near.data(), count, step.sets, step.far.data(), step.remainder,
           near);
  addParent(from, step);
  const std::uint8_t reach = lanesBelow(near.gradient, std::numeric_limits<double>::infinity());
  const bool last = k + 1 == map.count();
  const bool examined = (use != GroupUse::children || !last) && (reach & needed);
  if (!examined && use == GroupUse::test) return false;
  moveExpansion(from, step.sets, step.coefficients.data());
  addCharges(map.charges(k), from.near.data(), step.far.data(), 0, count, step.sets,
             step.coefficients.data());
  if (!examined) return false;
  whole_ = step.coefficients;
  addCharges(map.charges(k), from.near.data(), step.far.data(), 0xff, count, step.sets,
             whole_.data());
  examine(whole_.data(), sum(step.remainder, near), step.sets, step.findings);
  return true;
}

void SetGroup::compute(const MapSteps& map, const StepExpansions& parent, const LaneSets& sets,
                       std::uint8_t alive, GroupUse use) {
  steps_.resize(map.count());
  for (StepGroup& step : steps_) step.known = 0;
  proven_ = alive;
  enclosed_ = 0;
  std::uint8_t known = alive;
  for (std::size_t k = 0; k < map.count() && known; ++k) {
    StepGroup& step = steps_[k];
    step.sets = k == 0 ? sets : steps_[k - 1].findings.image;
    fillUnused(step.sets, known);
    step.known = known;
    const std::uint8_t needed = use == GroupUse::test ? proven_ & known : known;
    if (!computeStep(map, parent, k, use, needed)) {
      proven_ = 0;
      return;
    }
    proven_ &= known & lanesBelow(step.findings.excess, kProven);
    known &= finiteLanes(step.findings.image);
    if (k + 1 == map.count()) enclosed_ = known;
    if (use == GroupUse::test && proven_ == 0) return;
  }
  if (known == 0) proven_ = 0;
}

StepExpansions SetGroup::child(const StepExpansions& parent, int lane) const {
  StepExpansions out = parent;
  for (std::size_t k = 0; k < out.size(); ++k) {
    const StepGroup& step = steps_[k];
    if (!(step.known >> lane & 1)) break;
    auto child = std::make_shared<StepExpansion>();
    child->center = {step.sets.center[0][lane], step.sets.center[1][lane],
                     step.sets.center[2][lane]};
    child->coefficients.resize(kCoefficients);
    for (std::size_t i = 0; i < kCoefficients; ++i)
      child->coefficients[i] = step.coefficients[i * kLanes + lane];
    child->remainder = {step.remainder.gradient[lane], step.remainder.value[lane],
                        step.remainder.gradientMagnitude[lane],
                        step.remainder.valueMagnitude[lane]};
    const std::vector<std::uint32_t>& near = parent[k]->near;
    for (std::size_t i = 0; i < near.size(); ++i)
      if (!(step.far[i] >> lane & 1)) child->near.push_back(near[i]);
    out[k] = std::move(child);
  }
  return out;
}

}  // namespace innermap::proof
