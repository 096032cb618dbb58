// Which shells lie inside which.
#pragma once

#include <vector>

#include "innermap/surface/correspond.h"

namespace innermap {

// #shells: the shell directly around each (the one of least volume that most of it is inside of),
// or -1.
std::vector<int> parentShells(const std::vector<ClosedSurface>& shells);

}  // namespace innermap
