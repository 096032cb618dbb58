// Maps of a coarsened surface, cheap to try.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "innermap/surface/correspond.h"
#include "surface/detail/refining/anchor_flow.h"
#include "surface/detail/refining/progressive_mesh.h"
#include "surface/detail/refining/target_metric.h"

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
  std::vector<Anchor> drawn;  // brought near their targets, then set free
  double samples = 2500;      // of the energy
  int sweeps = 8;             // that lower it
  double near = 0.01;         // how far `drawn` may stay away, radians
  int patience = 20;          // FlowSettings
};

// Pulls the anchors, then lowers the energy. Empty where the way of `drawn` is blocked; where that
// of `fixed` is, `blocked` receives the anchor's number.
std::optional<CoarseMap> relaxCoarse(const CoarseSurface& coarse, const Layout& start,
                                     const TargetMetric& target, const CoarseMapSettings& settings,
                                     int* blocked = nullptr);

}  // namespace innermap
