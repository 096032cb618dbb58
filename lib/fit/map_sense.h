// The sense of a map: a mirror's image has det J < 0 wherever it is not folded.
#pragma once

#include <cstddef>

#include "innermap/fit/mapped_solid.h"

namespace innermap {

// Whether most of what was checked is turned over: a mirror's image, whose folds are the rest.
bool mirrors(const Injectivity& known);

// Of these points or cells: those against the map's sense.
std::size_t againstSense(const DeterminantFigures& figures, bool mirrored);

}  // namespace innermap
