// Results of the library in the terms of reports and the terminal.
#pragma once

#include <string>

#include "context.h"
#include "innermap/evaluate/grids.h"
#include "innermap/fit/fit_map.h"
#include "innermap/fit/frame_fitter.h"
#include "innermap/levelset/solid.h"
#include "report/report_figures.h"

namespace innermap::tool {

// What reports say of any mesh; handles, loops and caps are not known.
ReportMesh reportOf(const Mesh& mesh, double volume);

// Of a solid that is not checked: what reports say of its mesh.
void reportSolid(const Mesh& mesh, const Solid& solid, Report& report);

// Notes, warnings and seconds, and the report's "source" and, of a pair, "target".
void reportSource(const SourceBoundary& source, Context& context);
void reportBoundaries(const BoundaryPair& pair, Context& context);

// The same of a source that was laid onto a stranger: its image there, written to `path`, is the
// report's "laid"; "source" and "target" stay those of the two meshes as they were given.
void reportLaid(const BoundaryPair& pair, const std::string& path, Context& context);

// The same and "solve", "boundary_error" and "tolerance"; a line for the terminal. A tolerance that
// is not met is a warning with `bestEffort`, else the context's failure.
void reportFit(const MapFit& fit, const FitMapSettings& settings, bool bestEffort,
               Context& context);

// "solve" of a sequence.
void reportFitter(const FrameFitter& fitter, const FrameFitterSettings& settings, Report& report);

// "one_to_one"; a line for the terminal.
void reportInjectivity(const Injectivity& known, Context& context);

// Notes, warnings and seconds, "energy", "jacobian", "grid" and "one_to_one"; four lines.
void reportGrids(const SolidGrids& grids, const LameConstants& lame, Context& context);

// Why an adaptive fit ended short of its tolerance, in words.
std::string whyEnded(AdaptiveEnd end, std::size_t maxSources);

}  // namespace innermap::tool
