#pragma once

#include <vector>

#include "innermap/field/harmonic_field.h"
#include "proof/detail/field_tree.h"

namespace innermap::proof {

// Of each step of a map its tree.
class StepTrees {
 public:
  StepTrees(const ComposedMap& map, double scale, double farRatio = kFarRatio) {
    for (const HarmonicMap& step : map.steps()) trees_.emplace_back(step.field(), scale, farRatio);
  }
  std::size_t count() const { return trees_.size(); }
  const FieldTree& operator[](std::size_t step) const { return trees_[step]; }

 private:
  std::vector<FieldTree> trees_;
};

}  // namespace innermap::proof
