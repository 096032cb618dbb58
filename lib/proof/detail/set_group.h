// What a map in steps does to eight sets of points at once.
#pragma once

#include <cstdint>
#include <vector>

#include "proof/detail/field_tree.h"
#include "proof/detail/lane_kernels.h"
#include "proof/detail/step_trees.h"

namespace innermap::proof {

// All steps, one after the other. Its memory serves again.
class SetGroup {
 public:
  // The eight sets should lie near one another. alive: lanes that matter, one at least. senses:
  // what is wanted is whether each determinant keeps its sign; ends when no lane is left where it
  // does.
  void compute(const StepTrees& map, const LaneSets& sets, std::uint8_t alive, bool senses);

  // Lanes where each step's determinant keeps its sign on the whole set.
  std::uint8_t proven() const { return proven_; }
  // S, the largest of the steps up to the first where it is too large; infinite where nothing is
  // known of that one.
  double excess(int lane) const { return excess_[lane]; }
  // Lanes whose images after all steps are known.
  std::uint8_t enclosed() const { return enclosed_; }
  const LaneFindings& findings(std::size_t step) const { return findings_[step]; }

 private:
  bool computeStep(const FieldTree& tree, LaneSets& sets, std::uint8_t needed, LaneFindings& out);

  std::vector<LaneFindings> findings_;
  Numbers coefficients_ = Numbers(kCoefficients * kLanes);
  StepExpansion own_;          // about the whole group
  OrderedCharges far_, near_;  // of it
  std::vector<std::int32_t> places_;
  std::vector<double> nearest_;
  std::uint8_t proven_ = 0, enclosed_ = 0;
  Lanes excess_ = {};
};

}  // namespace innermap::proof
