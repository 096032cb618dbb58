#include "proof/detail/field_tree.h"

#include <tbb/cache_aligned_allocator.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace innermap::proof {
namespace {

constexpr std::size_t kNearCharges = 160;  // of a leaf, at most
constexpr int kMostLevels = 24;
// Of a node's ball, in half edges: more than the cube's own, so that sets across its faces fit.
constexpr double kReach = 2.2;

using Numbers = std::vector<double, tbb::cache_aligned_allocator<double>>;

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

LaneSets octants(const Vec3& center, double half) {
  LaneSets out{};
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    for (int a = 0; a < 3; ++a)
      out.center[a][lane] = center[a] + (lane >> a & 1 ? 0.5 : -0.5) * half;
    out.radius[lane] = kReach * 0.5 * half;
  }
  return out;
}

}  // namespace

FieldTree::FieldTree(const HarmonicField& field, double scale, double farRatio)
    : farRatio_(farRatio), charges_(packed(field, scale)), root_(std::make_unique<Node>()) {
  StepExpansion& expansion = root_->expansion;
  expansion = affineExpansion(field, scale);
  Box3 box;
  for (const Vec3& q : field.sources()) box.add(scale * q);
  if (box.empty()) return;
  const Vec3 extent = box.extent();
  root_->half = 0.5 * std::max({extent.x, extent.y, extent.z});
  // The affine part about the middle of the cube.
  Numbers moved(kCoefficients * kLanes);
  moveExpansion(expansion, octants(box.center(), 0), moved.data());
  expansion.remainder.valueMagnitude +=
      norm(box.center() - expansion.center) * expansion.remainder.gradientMagnitude;
  for (std::size_t i = 0; i < kCoefficients; ++i) expansion.coefficients[i] = moved[i * kLanes];
  expansion.center = box.center();
}

void FieldTree::split(const Node& parent) const {
  const StepExpansion& from = parent.expansion;
  const LaneSets sets = octants(from.center, parent.half);
  const std::size_t count = from.near.size();
  std::vector<std::uint8_t> far(count);
  Numbers all(kCoefficients * kLanes);
  LaneRemainders added, near;
  classify(charges(), from.near.data(), count, sets, farRatio_, far.data(), added, near);
  moveExpansion(from, sets, all.data());
  addCharges(charges(), from.near.data(), far.data(), 0, count, sets, all.data());
  addInherited(from, sets, added);
  auto children = std::make_unique<std::array<Node, kLanes>>();
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    Node& node = (*children)[lane];
    node.half = 0.5 * parent.half;
    node.level = parent.level + 1;
    StepExpansion& child = node.expansion;
    child.center = {sets.center[0][lane], sets.center[1][lane], sets.center[2][lane]};
    child.coefficients.resize(kCoefficients);
    for (std::size_t i = 0; i < kCoefficients; ++i) child.coefficients[i] = all[i * kLanes + lane];
    child.remainder = {added.gradient[lane], added.value[lane], added.gradientMagnitude[lane],
                       added.valueMagnitude[lane]};
    for (std::size_t i = 0; i < count; ++i)
      if (!(far[i] >> lane & 1)) child.near.push_back(from.near[i]);
  }
  parent.children = std::move(children);
}

const StepExpansion& FieldTree::about(const Vec3& center, double radius) const {
  const Node* node = root_.get();
  while (node->expansion.near.size() > kNearCharges && node->level < kMostLevels) {
    const Vec3& middle = node->expansion.center;
    const double half = 0.5 * node->half;
    int octant = 0;
    Vec3 child = middle;
    for (int a = 0; a < 3; ++a) {
      if (center[a] > middle[a]) octant |= 1 << a;
      child[a] += center[a] > middle[a] ? half : -half;
    }
    if (!(norm(center - child) + radius <= kReach * half * (1 - 1e-12))) break;
    std::call_once(node->splitting, [&] { split(*node); });
    node = &(*node->children)[octant];
  }
  return node->expansion;
}

}  // namespace innermap::proof
