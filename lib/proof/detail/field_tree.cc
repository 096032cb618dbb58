#include "proof/detail/field_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "proof/detail/surface_pieces.h"

namespace innermap::proof {
namespace {

constexpr std::size_t kNearCharges = 160;  // of a leaf, at most
constexpr int kMostLevels = 24;
// Of a node's ball, in half edges: more than the cube's own, so that sets across its faces fit.
constexpr double kReach = 2.2;

// Along a curve, so that charges near one another lie near in memory too.
std::vector<std::size_t> alongCurve(const Points& sources) {
  const Box3 box = boundingBox(sources);
  std::vector<std::pair<std::uint32_t, std::size_t>> keyed;
  for (std::size_t j = 0; j < sources.size(); ++j) keyed.emplace_back(curveKey(sources[j], box), j);
  std::sort(keyed.begin(), keyed.end());
  std::vector<std::size_t> out;
  for (const auto& [key, j] : keyed) out.push_back(j);
  return out;
}

Numbers packed(const HarmonicField& field, double scale) {
  const Points& sources = field.sources();
  Numbers out(kChargeStride * sources.size());
  double* q = out.data();
  for (const std::size_t j : alongCurve(sources)) {
    Vec3 weight;
    for (int k = 0; k < 3; ++k) {
      q[k] = scale * sources[j][k];
      weight[k] = q[3 + k] = scale * scale * field.weights()(j, k);
    }
    q[6] = norm(weight) * (1 + 1e-15);
    q += kChargeStride;
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

}  // namespace

FieldTree::FieldTree(const HarmonicField& field, double scale, double farRatio)
    : limits_(proof::orderLimits(farRatio)),
      charges_(packed(field, scale)),
      root_(std::make_unique<Node>()) {
  const StepExpansion affine = affineExpansion(field, scale);
  Box3 box;
  for (const Vec3& q : field.sources()) box.add(scale * q);
  if (box.empty()) {
    root_->expansion = affine;
    return;
  }
  const Vec3 extent = box.extent();
  root_->half = 0.5 * std::max({extent.x, extent.y, extent.z});
  expandAbout(charges(), affine, kOrder, {}, {box.center(), 0}, root_->expansion);
  root_->expansion.near = affine.near;
}

std::unique_ptr<FieldTree::Node> FieldTree::childOf(const Node& parent, const Vec3& center) const {
  auto child = std::make_unique<Node>();
  child->half = 0.5 * parent.half;
  child->level = parent.level + 1;
  const ExpansionBall ball{center, kReach * child->half};
  OrderedCharges far;
  std::vector<std::int32_t> places;
  sortCharges(charges(), parent.expansion.near, ball, limits_, places, far);
  expandAbout(charges(), parent.expansion, kOrder, far, ball, child->expansion);
  child->expansion.near.assign(far.list.begin() + static_cast<std::ptrdiff_t>(far.count()),
                               far.list.end());
  return child;
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
    std::unique_ptr<Node>& made = node->children[octant];
    std::call_once(node->making[octant], [&] { made = childOf(*node, child); });
    node = made.get();
  }
  return node->expansion;
}

}  // namespace innermap::proof
