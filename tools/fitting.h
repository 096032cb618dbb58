// From two boundaries to a map and its certificate: what `fit` and `map` share.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "boundary_pair.h"
#include "command.h"
#include "innermap/field/boundary_error.h"
#include "innermap/field/field_file.h"

namespace innermap::tool {

struct FittingOptions {
  std::uint64_t sources = 2000;
  std::optional<std::uint64_t> collocation;
  std::optional<double> sourceRatio, collocationRatio;  // per vertex of the source mesh
  std::optional<double> distance, radiusRatio;
  std::string solver = "auto";
  std::string interpolation = "auto";
  std::string method = "tikhonov";
  std::optional<double> regularization;
  std::uint64_t seed = 1;
};

void addFittingOptions(Command& command, FittingOptions& options);

// Numbers of points that the options mean for a mesh of so many vertices.
struct PointCounts {
  std::size_t sources = 0, collocation = 0, heldOut = 0;
};
PointCounts pointCounts(const FittingOptions& options, std::size_t vertices);

// Peak need in bytes.
std::uint64_t fittingMemory(const PointCounts& counts, const FittingOptions& options);

// Throws MemoryError, with the largest --sources that would fit, when the need is over the limit.
void requireFittingMemory(const PointCounts& counts, const FittingOptions& options,
                          const Context& context);

struct Fitted {
  FieldFile file;
  BoundaryError error;  // at fresh points
};

// Fills the report's "solve" and "boundary_error".
Fitted fitMap(const BoundaryPair& pair, const FittingOptions& options, Context& context);

}  // namespace innermap::tool
