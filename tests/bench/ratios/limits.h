// What the machine gives at most on this run's threads, and which share of it a figure reaches.
#pragma once

#include "results.h"

namespace innermap::bench {

struct Limits {
  double copied = 0;      // bytes a second, read and written, by a copy larger than the caches
  double multiplied = 0;  // multiply-adds a second in double precision, by dgemm
  double summed = 0;      // pairs of point and charge a second, three channels, values and
                          // gradients, by the kernel with all charges in the first cache
};

// The best of a few tries each, one or two seconds in all. quick: small sizes.
Limits measureLimits(int threads, bool quick);

Json asJson(const Limits& limits);

// The least that some work has to do.
struct Work {
  double bytes = 0, multiplyAdds = 0, pairs = 0;
};

// {"limit s", "of limit %"}: what the work takes at the machine's limits, and that over `seconds`.
Json besideLimit(const Limits& limits, const Work& work, double seconds);

}  // namespace innermap::bench
