// First maps of one sphere on another, between which a judge chooses.
#pragma once

#include "surface/detail/refining/laid_out_shell.h"
#include "surface/detail/refining/map_refiner.h"
#include "surface/detail/sphere/sphere_candidates.h"

namespace innermap {

constexpr std::size_t kMiddle = 600;  // vertices that maps are refined to before some are chosen

// The map of the way that is wanted (settings.wanted), refined to the end, with what was considered
// and the other way where there is one as good. settings.candidates are refined a little and judged
// again: from there on what a judge sees changes little. Throws as mapShell().
ShellMap judgedMapOf(const LaidOutShell& a, const LaidOutShell& b, const Candidates& candidates,
                     const RefineSettings& refining, const ShellMapSettings& settings);

// Images of a judge's points on `surface`, A's or coarser, by its layout on B's model space.
Points imagesOf(const std::vector<SurfacePoint>& points, const ClosedSurface& surface,
                const Layout& image, const LaidOutShell& b, const Locator& onB);

}  // namespace innermap
