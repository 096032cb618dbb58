// Two builds measured in turn.
#pragma once

#include <string>
#include <vector>

#include "section.h"

namespace innermap::bench {

struct Against {
  std::string ratios;  // innermap_ratios of the other build, in its folder tests/bench
  int rounds = 3;
};

// Runs the sections by this innermap_ratios and by the other in turn, each round the other way
// round. A section that the other lacks is measured by this one with the other's program; what of
// that does not run the program is left out. Prints and returns a table of seconds: the medians of
// both, and this build's over the other's, median, least and most of the rounds. Throws
// innermap::Error if one of them fails.
Json compare(const Against& against, const std::vector<std::string>& sections,
             const Options& options);

}  // namespace innermap::bench
