// What plain sums give at a few points, and so what errors are allowed at all.
#pragma once

#include <vector>

#include "innermap/solve/kernel_sum.h"

namespace innermap {

class SumReference {
 public:
  // accuracy, absolute: as in FastSumSettings.
  SumReference(FieldSamples exact, double accuracy, double absolute);

  // The relative accuracy that all channels need.
  double accuracy() const;

  // Of sums at the same points: the largest error over what is allowed.
  double excess(const FieldSamples& got) const;

  // Of values at the same points: the largest root mean square error of a channel, in their units.
  double error(const FieldSamples& got) const;

  // Where charges nearly cancel their sums are exact to rounding of the charges' own sizes, no
  // more: from now on as much is allowed. magnitudes: the sums of absolute weights, at the same
  // points.
  void allowRounding(const FieldSamples& magnitudes);
  bool allowsRounding() const { return allowsRounding_; }

 private:
  FieldSamples exact_;
  std::vector<double> relative_;  // of each channel
  std::vector<double> rounding_;  // relative to the values too; where it is allowed
  bool allowsRounding_ = false;
};

}  // namespace innermap
