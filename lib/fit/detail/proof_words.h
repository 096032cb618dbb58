// Words that statements and claims share.
#pragma once

#include <string>

#include "innermap/fit/mapped_solid.h"

namespace innermap {

// So many digits, rounded to the side on which a bound still holds: "0.0106" of 0.010551.
std::string atMost(double bound, int digits = 3);
std::string atLeast(double bound, int digits = 3);

// Whether proofs tell how many points go to a place: where the target's winding numbers are those
// of the image.
bool countsPreimages(const Injectivity& known);

// Whether that is one for each point that is deep enough in the target: its surface winds about
// that once.
bool countsPointsOnce(const Injectivity& known);

// "each point farther than ... has as many preimages as ..."
std::string preimages(const Injectivity& known);

}  // namespace innermap
