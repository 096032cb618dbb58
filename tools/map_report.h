// Results of the library in the terms of reports and the terminal.
#pragma once

#include <string>

#include "context.h"
#include "innermap/boundary/fit_map.h"
#include "innermap/boundary/frame_fitter.h"
#include "innermap/evaluate/map_grids.h"

namespace innermap::tool {

// Notes, warnings and seconds of a result.
void tell(const std::vector<std::string>& notes, const std::vector<std::string>& warnings,
          const StageSeconds& seconds, Context& context);

// The report's "source" and, of a pair, "target".
void reportSource(const SourceBoundary& source, Report& report);
void reportBoundaries(const BoundaryPair& pair, Report& report);

// A map from its file; what is known of its boundaries is told.
MappedSolid readMapFile(const std::string& path, Context& context);

// The report's "solve", "boundary_error" and "tolerance". A tolerance that is not met is a warning
// with `bestEffort`, else the context's failure.
void reportFit(const MapFit& fit, const FitMapSettings& settings, bool bestEffort,
               Context& context);

// "solve" of a sequence.
void reportFitter(const FrameFitter& fitter, const FrameFitterSettings& settings, Report& report);

// "energy", "jacobian" and "grid".
void reportGrids(const SolidGrids& grids, const LameConstants& lame, Report& report);

// Lines for the terminal.
std::string errorText(const BoundaryError& error);
std::string gridsText(const SolidGrids& grids);

}  // namespace innermap::tool
