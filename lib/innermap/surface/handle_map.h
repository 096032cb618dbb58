// Internal to surface/: surfaces of genus 2 and more, mapped by way of cuts along meridians.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "innermap/surface/closed_surface.h"
#include "innermap/surface/cut_handles.h"
#include "innermap/surface/layout.h"
#include "innermap/surface/shell_map.h"

namespace innermap {

struct HandleMap {
  CutSurface source, target;  // cut and capped, of genus 0
  Layout image, targetLayout;
  std::vector<std::pair<int, SurfacePoint>> exact;  // vertices of source that were held: on target
  std::string origin;
  std::string note;  // empty, or which landmarks would decide what is nearly a tie
};

// landmarks: vertices of A and points of B, both before the cuts. Throws as mapShell().
HandleMap mapHandles(const HandleLoops& a, const HandleLoops& b,
                     const std::vector<std::pair<int, SurfacePoint>>& landmarks,
                     const ShellMapSettings& settings);

}  // namespace innermap
