// From two boundaries to a map and its certificate: what `fit` and `map` share.
#pragma once

#include <optional>
#include <string>

#include "boundary_pair.h"
#include "fitting_options.h"
#include "innermap/field/boundary_error.h"
#include "innermap/field/field_file.h"

namespace innermap::tool {

struct Fitted {
  FieldFile file;
  BoundaryError error;  // at fresh points
};

// Fills the report's "solve", "boundary_error" and "tolerance". A tolerance that is not met stands
// in the file's settings; it is a warning with --best-effort, otherwise the context's failure.
Fitted fitMap(const BoundaryPair& pair, const FittingOptions& options, Context& context);

}  // namespace innermap::tool
