// How to sum: plainly or by a hierarchy, and with which orders.
#pragma once

#include <cstddef>

#include "innermap/solve/detail/far_field.h"
#include "innermap/solve/fast_sum.h"

namespace innermap {

// For sums with this relative accuracy, in [1e-12, 0.1].
FarFieldSettings planFor(double accuracy);

// After the error was `excess` times what is allowed; the order may pass the highest there is.
FarFieldSettings raised(FarFieldSettings plan, double excess);

struct SumSize {
  std::size_t charges = 0, points = 0;
  std::size_t pointsPerLeaf = 1;
  int order = 0;
  bool gradients = false;
};

// Whether a hierarchy takes less time, or is asked for.
bool useHierarchy(const SumSize& size, SumMethod method);

}  // namespace innermap
