// The steps of a map as the proof wants them, and what they do to eight sets at once.
#pragma once

#include <tbb/cache_aligned_allocator.h>

#include <array>
#include <cstdint>
#include <vector>

#include "innermap/field/harmonic_field.h"
#include "proof/detail/lane_kernels.h"
#include "proof/detail/step_expansion.h"

namespace innermap::proof {

using AlignedNumbers = std::vector<double, tbb::cache_aligned_allocator<double>>;

// Lengths before and after each step are multiplied by `scale`, a power of two: no digit changes.
class MapSteps {
 public:
  MapSteps(const ComposedMap& map, double scale);

  std::size_t count() const { return charges_.size(); }
  const double* charges(std::size_t step) const { return charges_[step].data(); }
  // The affine parts, and all charges as near ones.
  const StepExpansions& start() const { return start_; }

 private:
  std::vector<std::vector<double>> charges_;
  StepExpansions start_;
};

// One step on eight sets that lie within the set of one expansion.
struct StepGroup {
  LaneSets sets;
  LaneRemainders remainder;       // of `coefficients`
  AlignedNumbers coefficients;    // kCoefficients x kLanes: the far charges
  std::vector<std::uint8_t> far;  // of the near charges of the expansion: by lane
  LaneFindings findings;          // with all charges
  std::uint8_t known = 0;         // lanes whose sets are known
};

enum class GroupUse {
  test,      // findings alone; ends where no lane is left that could be proven
  children,  // expansions for the eight sets alone
  both
};

// All steps, one after the other. Its memory serves again.
class SetGroup {
 public:
  // parent: the expansions for a set that holds the eight ones. alive: lanes that matter.
  void compute(const MapSteps& map, const StepExpansions& parent, const LaneSets& sets,
               std::uint8_t alive, GroupUse use);

  const StepGroup& step(std::size_t k) const { return steps_[k]; }
  // Lanes where each step's determinant keeps its sign on the whole set.
  std::uint8_t proven() const { return proven_; }
  // Lanes whose images after all steps are known: step(last).findings.image.
  std::uint8_t enclosed() const { return enclosed_; }

  // Of one of the sets. Steps about which nothing is known keep the parent's.
  StepExpansions child(const StepExpansions& parent, int lane) const;

 private:
  bool computeStep(const MapSteps& map, const StepExpansions& parent, std::size_t k, GroupUse use,
                   std::uint8_t needed);

  std::vector<StepGroup> steps_;
  AlignedNumbers whole_;  // coefficients of all charges
  std::uint8_t proven_ = 0, enclosed_ = 0;
};

}  // namespace innermap::proof
