// How to sum: plainly or by a hierarchy, and with which orders.
#pragma once

#include <cstddef>

#include "solve/detail/far_field.h"

namespace innermap {

// For sums with this accuracy, above 0, as a share of the sums of absolute weights.
FarFieldPlan planFor(double accuracy);

// After the error was `excess` times what is allowed; the order may pass the highest there is.
FarFieldPlan raised(FarFieldPlan plan, double excess);

constexpr int kLeastOrder = 5;

struct SumSize {
  std::size_t charges = 0, points = 0;
  std::size_t pointsPerLeaf = 1;
  int order = kLeastOrder;
  bool gradients = false;
};

// Whether a hierarchy takes less time than plain sums.
bool hierarchyIsCheaper(const SumSize& size);

// Whether plain sums take a second or two of one core at most, whatever a hierarchy takes.
bool plainIsCheap(const SumSize& size);

}  // namespace innermap
