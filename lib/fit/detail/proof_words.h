// What proofs say together of how many points go to a place.
#pragma once

#include <string>

#include "innermap/fit/mapped_solid.h"

namespace innermap {

// Whether that is a theorem: where the target's winding numbers are those of the image.
bool countsPreimages(const Injectivity& known);

// "each point farther than ... has as many preimages as ..."
std::string preimages(const ProofFigures& proof);

}  // namespace innermap
