#include "innermap/boundary/map_fit.h"

#include <algorithm>

namespace innermap {
namespace {

constexpr double kPointsPerSource = 4, kPointsPerManySources = 3;

}  // namespace

std::size_t shellCollocation(const ShellSettings& shell) {
  if (shell.collocation > 0) return shell.collocation;
  const double perSource =
      shell.sources > kMostDenseSources ? kPointsPerManySources : kPointsPerSource;
  return static_cast<std::size_t>(std::max(perSource * static_cast<double>(shell.sources), 16.0));
}

}  // namespace innermap
