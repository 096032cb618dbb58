// The settings that would fit.
#pragma once

#include <cstdint>

namespace innermap::tool {

// The largest n in [lower, upper] with fits(n), where all smaller ones fit too; 0 when none does.
template <class Predicate>
std::uint64_t largestThat(std::uint64_t lower, std::uint64_t upper, const Predicate& fits) {
  if (!fits(lower)) return 0;
  while (lower < upper) {
    const std::uint64_t middle = lower + (upper - lower + 1) / 2;
    if (fits(middle))
      lower = middle;
    else
      upper = middle - 1;
  }
  return lower;
}

}  // namespace innermap::tool
