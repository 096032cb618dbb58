// What plain sums give at a few points, and so what errors are allowed at all.
#pragma once

#include <vector>

#include "innermap/solve/kernel_sum.h"

namespace innermap {

class SumReference {
 public:
  // magnitudes: the sums of absolute weights, at the same points; gradients are not read. accuracy,
  // absolute: as in FastSumSettings.
  SumReference(FieldSamples exact, const FieldSamples& magnitudes, double accuracy,
               double absolute);

  // What all channels need, as a share of the magnitudes: where charges nearly cancel, far less
  // than of the values.
  double accuracy() const;

  // Of sums at the same points: the largest error over what is allowed.
  double excess(const FieldSamples& got) const;

  // Of values at the same points: the largest root mean square error of a channel, in their units.
  double error(const FieldSamples& got) const;

 private:
  FieldSamples exact_;
  std::vector<double> relative_;       // of each channel
  std::vector<double> magnification_;  // of each channel: its magnitudes to its values
};

}  // namespace innermap
