// How seconds grow with size, of the tables that hold several sizes.
#pragma once

#include <string>

#include "results.h"

namespace innermap::bench {

// Fits seconds = c size^e by least squares of the logarithms: an array of {"what", "by", "from",
// "to", "exponent"}, of those curves that the sections have two points of. Draws them into `chart`,
// an .svg file, unless that is empty.
Json growth(const Json& sections, const std::string& chart);

}  // namespace innermap::bench
