// Options of `fit` and `map` that say how a map is fitted.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "command.h"
#include "innermap/field/fit.h"

namespace innermap::tool {

struct FittingOptions {
  std::optional<double> tolerance;
  bool bestEffort = false;
  std::uint64_t maxSources = 100000;
  std::optional<std::uint64_t> sources, collocation;
  std::optional<double> sourceRatio, collocationRatio;  // per vertex of the source mesh
  std::optional<double> distance, radiusRatio;
  std::string solver = "auto";
  std::string interpolation = "auto";
  std::string method = "tikhonov";
  std::optional<double> regularization;
  std::uint64_t seed = 1;
};

void addFittingOptions(Command& command, FittingOptions& options);

// The tolerance that the charges are placed for, a fraction of the target's diagonal; nothing where
// the options place a number of them. Throws UsageError for a tolerance that cannot be and for
// options that exclude each other.
std::optional<double> toleranceOf(const FittingOptions& options);

// Numbers of points that the options mean for a mesh of so many vertices.
struct PointCounts {
  std::size_t sources = 0, collocation = 0, heldOut = 0;
};
PointCounts pointCounts(const FittingOptions& options, std::size_t vertices);

FitSolver solverOf(const FittingOptions& options);

// Peak need in bytes; with a tolerance, that of its first level of charges.
std::uint64_t fittingMemory(const FittingOptions& options, std::size_t vertices);

// Throws MemoryError, with the largest --sources that would fit, when the need is over the limit.
void requireFittingMemory(const FittingOptions& options, std::size_t vertices,
                          const Context& context);

// "fit 2000 charges to 8000 boundary points", for --dry-run.
std::string fittingPlan(const FittingOptions& options, std::size_t vertices);

}  // namespace innermap::tool
