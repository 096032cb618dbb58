// Which shell of one solid goes to which of another.
#pragma once

#include <utility>
#include <vector>

#include "innermap/surface/correspond.h"

namespace innermap {

struct ShellPairSettings {
  std::vector<std::pair<int, int>> wanted;  // shells of A and B that landmarks connect
  bool aligned = false;                     // the nearest of equals; otherwise the largest first
};

// For each shell of A the one of B: outer ones to outer ones, those directly inside to those
// directly inside, each to one of the same genus whose own inner shells are alike. Throws DataError
// where the two have no such pairing, with both nestings.
std::vector<int> pairShells(const SurfaceShells& a, const SurfaceShells& b,
                            const ShellPairSettings& settings = {});

}  // namespace innermap
