// Where a surface's limbs end, and which of them answer to another's.
#pragma once

#include <utility>
#include <vector>

#include "innermap/surface/correspond.h"

namespace innermap {

struct LimbTips {
  std::vector<int> vertices;                  // farthest out first; at most 8
  std::vector<double> centrality;             // of each: mean geodesic distance to the surface
  std::vector<std::vector<double>> distance;  // geodesic, between tips; all for unit area
  Points place;                               // of each in the layout
};

// Local maxima of the average geodesic distance (Hilaga, Shinagawa, Kohmura, Kunii, "Topology
// matching for fully automatic similarity estimation of 3D shapes", SIGGRAPH 2001), on the surface
// coarsened to `vertices`; distances along edges and across pairs of triangles.
LimbTips limbTips(const ClosedSurface& surface, const Layout& layout, std::size_t vertices = 800);

using TipPairs = std::vector<std::pair<int, int>>;  // tip of A, tip of B

// The best partial matchings of three tips or more, best first: geodesic
// distances should agree, and on the sphere the orientation of triples. All are tried (Zhang,
// Sheffer, Cohen-Or, Zhou, van Kaick, Tagliasacchi, "Deformation-driven shape correspondence", SGP
// 2008).
std::vector<TipPairs> matchTips(const LimbTips& a, const LimbTips& b, std::size_t most);

}  // namespace innermap
