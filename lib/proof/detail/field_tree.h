// One step's map, expanded in the balls of an octree about its charges.
//
// A node's expansion is its parent's, moved, and charges enter it where they are far from its ball.
// So what is near a small set of points is known without looking at all charges.
#pragma once

#include <cstdint>
#include <vector>

#include "innermap/field/harmonic_field.h"
#include "proof/detail/lane_kernels.h"
#include "proof/detail/step_expansion.h"

namespace innermap::proof {

// Immutable after construction; safe from any number of threads.
class FieldTree {
 public:
  // Lengths before and after the step are multiplied by `scale`, a power of two: no digit changes.
  // Throws Cancelled.
  FieldTree(const HarmonicField& field, double scale);

  const double* charges() const { return charges_.data(); }  // kChargeStride each

  // An expansion that holds for all points of this ball: of the smallest node about it.
  const StepExpansion& about(const Vec3& center, double radius) const;

  // Bytes that trees of so many charges take, about.
  static std::uint64_t memory(std::size_t charges) { return 8000 * charges + (4u << 20); }

 private:
  struct Node {
    StepExpansion expansion;
    double half = 0;  // of its cube's edge
    std::int32_t firstChild = -1;
  };
  void split(const Node& parent, std::vector<Node>& children) const;

  std::vector<double> charges_;
  std::vector<Node> nodes_;  // the first: affine part, and all charges near; holds everywhere
};

}  // namespace innermap::proof
