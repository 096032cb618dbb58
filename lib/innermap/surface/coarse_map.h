// Internal to surface/: maps of a coarsened surface, cheap to try.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "innermap/core/progress.h"
#include "innermap/surface/anchor_flow.h"
#include "innermap/surface/closed_surface.h"
#include "innermap/surface/layout.h"
#include "innermap/surface/progressive_mesh.h"
#include "innermap/surface/target_metric.h"

namespace innermap {

// What is left of a surface when it has been coarsened.
struct CoarseSurface {
  ClosedSurface surface;
  std::vector<int> vertex;          // of the fine surface, of each of its vertices
  std::vector<int> index;           // the other way: of each fine vertex, -1 where it is gone
  std::vector<CornerShifts> shift;  // torus
};

// All present vertices and triangles of the mesh.
CoarseSurface coarseSurface(const ClosedSurface& surface, const ProgressiveMesh& mesh);

struct CoarseMap {
  Layout image;  // of the coarse surface
  double energy = 0;
  std::string origin;  // how it was found, for messages
};

struct CoarseMapSettings {
  std::vector<Anchor> fixed;  // coarse vertices that must be at their targets
  std::vector<Anchor> drawn;  // brought to their targets, then set free
  Progress* progress = nullptr;
};

// Pulls the anchors, then lowers the energy. Empty where the way of `drawn` is blocked; where that
// of `fixed` is, `blocked` receives the anchor's number.
std::optional<CoarseMap> relaxCoarse(const CoarseSurface& coarse, const Layout& start,
                                     const TargetMetric& target, const CoarseMapSettings& settings,
                                     int* blocked = nullptr);

struct RefineSettings {
  std::vector<char> fixed;  // #V of the fine surface or empty
  bool relax = true;        // otherwise vertices return to where their rings let them, no more
  Progress* progress = nullptr;
};

// The map of the fine surface, from that of the coarse one: all vertices return, lowering the
// energy. `mesh` is the fine surface's, coarsened as for coarseSurface(). Empty where rounding
// leaves no place for some vertex.
std::optional<CoarseMap> refineMap(const ClosedSurface& surface, ProgressiveMesh mesh,
                                   const CoarseSurface& coarse, const CoarseMap& start,
                                   const TargetMetric& target, const RefineSettings& settings);

}  // namespace innermap
