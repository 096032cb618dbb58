// One step's map, expanded in the balls of an octree about its charges.
//
// A node's expansion is its parent's, moved, and charges enter it where they are far from its ball.
// So what is near a small set of points is known without looking at all charges. Nodes are made
// when they are first asked for: most of the space about the charges never is.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "innermap/field/harmonic_field.h"
#include "proof/detail/ball_expansion.h"

namespace innermap::proof {

// Charges are far from a set when its radius is at most this part of their distance: then they
// enter its expansion.
constexpr double kFarRatio = 0.36;
// What an expansion cuts off is some 1e-5 of all that it holds, however small a set within its node
// is; with this ratio some 1e-8, with more charges near.
constexpr double kFineFarRatio = 0.2;

// Safe from any number of threads; what it says does not depend on what was asked before.
class FieldTree {
 public:
  // Lengths before and after the step are multiplied by `scale`, a power of two: no digit changes.
  FieldTree(const HarmonicField& field, double scale, double farRatio = kFarRatio);

  const OrderLimits& orderLimits() const { return limits_; }

  const double* charges() const { return charges_.data(); }  // kChargeStride each

  // How many times larger rounding errors may be for the number of charges: one unit more for each
  // that is added up.
  double rounding() const {
    return 1 + 1.2e-4 * static_cast<double>(charges_.size() / kChargeStride);
  }

  // An expansion that holds for all points of this ball: of the smallest node about it.
  const StepExpansion& about(const Vec3& center, double radius) const;

  // Bytes that trees of so many charges take, about.
  static std::uint64_t memory(std::size_t charges) { return 8000 * charges + (4u << 20); }

 private:
  struct Node {
    StepExpansion expansion;
    double half = 0;  // of its cube's edge
    int level = 0;
    mutable std::array<std::once_flag, kLanes> making;
    mutable std::array<std::unique_ptr<Node>, kLanes> children;
  };
  std::unique_ptr<Node> childOf(const Node& parent, const Vec3& center) const;

  OrderLimits limits_;
  Numbers charges_;             // each in one line of the cache
  std::unique_ptr<Node> root_;  // the affine part, and all charges near: it holds everywhere
};

}  // namespace innermap::proof
