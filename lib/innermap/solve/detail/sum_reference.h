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

 private:
  FieldSamples exact_;
  std::vector<double> relative_;  // of each channel
};

}  // namespace innermap
