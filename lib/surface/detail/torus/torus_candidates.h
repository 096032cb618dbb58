// How the layout of one torus may be carried onto another's.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "innermap/surface/correspond.h"

namespace innermap {

struct TorusSearch {
  std::size_t count = 3;  // of candidates, at most
  bool aligned = false;   // the surfaces stand in the same pose: prefer agreeing normals
  // Points of A's layout and the points of B's where they belong.
  std::vector<std::pair<Vec3, Vec3>> landmarks;
  int twists = 3;             // at most, either way, of A's longitude around B's tube
  int grid = 24;              // translations along each period
  std::size_t samples = 250;  // on either surface
  std::uint64_t seed = 1;
};

struct TorusCandidate {
  Layout image;  // of A on B's torus: B's periods; as valid as A's own layout
  double cost = 0;
  bool reversed = false;  // both meridian and longitude run backwards on B
  int twist = 0;          // A's longitude goes to B's longitude and so many meridians
};

// Affine maps of the plane that carry A's lattice to B's and the meridian to plus or minus the
// meridian, so that the map extends to the solids: reversed or not, each twist, and of each the
// translations that are best locally. The best first, different from one another by another
// lattice map or by 0.35 in the plane (areas are 4 pi). Cost: mean of ln^2 s1 + ln^2 s2 over
// samples of both surfaces, of the map between the surfaces scaled to the same area; with `aligned`
// plus twice the mean of 1 - the cosine between normals. Landmarks fix the translation by least
// squares; their mean squared distance in the plane then counts tenfold.
//
// Both layouts as layOutTorus() makes them. Same result for any number of threads. Throws
// Cancelled.
std::vector<TorusCandidate> torusCandidates(const ClosedSurface& a, const Layout& layoutOfA,
                                            const ClosedSurface& b, const Layout& layoutOfB,
                                            const TorusSearch& settings = {});

}  // namespace innermap
