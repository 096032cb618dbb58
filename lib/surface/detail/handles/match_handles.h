// Which handle of one cut surface goes to which of another, and how the cuts'
// rims lie on one another. With that, a map between the cut surfaces is one between the uncut.
#pragma once

#include <utility>
#include <vector>

#include "innermap/surface/correspond.h"
#include "surface/detail/handles/cut_handles.h"

namespace innermap {

struct HandleMatch {
  std::vector<int> target;    // for each handle of A, the handle of B
  std::vector<char> swapped;  // whether side 0 goes to side 1 there
  Mat3 rotation{};  // of A's layout that brings the caps' centres nearest to their targets
  double cost = 0;
};

struct HandleSearch {
  std::size_t count = 3;  // of matches, at most
  bool aligned = false;   // the surfaces stand in the same pose: prefer handles at the same place
  // Points of A's layout on the sphere and the points of B's where they belong: they decide.
  std::vector<std::pair<Vec3, Vec3>> landmarks;
};

// The best first. Any assignment of handles and sides extends to the solids, as discs close the
// cuts. Cost: differences of the logarithms of the distances on the surfaces between cuts and of
// the cuts' lengths, both for surfaces of unit area, and squared distances on the sphere after the
// best rotation, which tell mirror images apart. All assignments of up to six handles are tried,
// above that descents from many. Both cut surfaces with their layouts by layOutSphere(), of equally
// many handles. Deterministic. Throws Cancelled.
std::vector<HandleMatch> matchHandles(const CutSurface& a, const Layout& layoutOfA,
                                      const CutSurface& b, const Layout& layoutOfB,
                                      const HandleSearch& settings = {});

// Vertices of A's cut surface that must stand at points of B's.
struct SeamedSurface {
  CutSurface cut;  // A's, with vertices put in on the rims where B's rims have theirs, so that rims
  Layout layout;   // can coincide
  std::vector<std::pair<int, SurfacePoint>> fixed;  // the rims' vertices and the caps' centres
};

// Rims go to rims by length along them, from where their directions on the sphere agree best on
// both sides; both copies of a vertex go to copies of one point. Vertices of both that would nearly
// coincide do.
SeamedSurface seamed(const CutSurface& a, const Layout& layoutOfA, const CutSurface& b,
                     const Layout& layoutOfB, const HandleMatch& match);

}  // namespace innermap
