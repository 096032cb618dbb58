// Chosen vertices brought to chosen places without a flip.
#pragma once

#include <vector>

#include "innermap/surface/correspond.h"
#include "surface/detail/refining/coarse_to_fine.h"
#include "surface/detail/refining/progressive_mesh.h"

namespace innermap {

struct Anchor {
  int vertex = 0;
  Vec3 target;  // unit vector, or a point of the plane z = 1 (any of its copies)
};

// From one place to another: tangent vector at `from`, the length of the way. On the torus the
// nearest copy.
Vec3 wayTo(const Layout& layout, const Vec3& from, const Vec3& to);

struct FlowSettings {
  std::size_t exact = 0;  // the first so many anchors must arrive exactly
  double near = 0.1;      // the others so near, radians
  int patience = 20;      // steps without headway until the way counts as blocked
};

// Flows all vertices that are present along a smooth velocity field that carries the anchors to
// their targets (Joshi and Miller, "Landmark matching via large deformation diffeomorphisms",
// 2000), relaxing the others on the way, until the anchors are there. Returns the anchor that is
// farthest from its target where the way is blocked, -1 when all have arrived. `relaxer` must keep
// the anchors fixed.
int pullAnchors(const ProgressiveMesh& mesh, Layout& layout, const std::vector<Anchor>& anchors,
                CoarseToFine& relaxer, const FlowSettings& settings);

}  // namespace innermap
