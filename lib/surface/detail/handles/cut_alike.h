// Two surfaces with handles cut so that the cuts answer to one another.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "surface/detail/handles/cut_handles.h"
#include "surface/detail/handles/match_handles.h"

namespace innermap {

struct CutAlikeSettings {
  bool aligned = false;                                 // the surfaces stand in the same pose
  std::vector<std::pair<int, SurfacePoint>> landmarks;  // vertices of A, points of B (uncut)
  std::size_t systems = 5;                              // of B's loops that are tried, at most
};

struct CutPair {
  CutSurface a, b;
  Layout layoutOfA, layoutOfB;  // on the sphere
  HandleMatch match;
  std::string note;  // empty, or which landmarks would decide what is nearly a tie
};

// A is cut along its shortest meridians; of B's loops those are cut that answer to A's best by
// their lengths, the distances between them and to landmarks (and their places when aligned). The
// systems that fit best, and the shortest, are cut and laid out, and the one whose handles match
// best is taken. Both must have equally many handles, more than none. Deterministic. Throws what
// layOutSphere() throws.
CutPair cutAlike(const HandleLoops& a, const HandleLoops& b, const CutAlikeSettings& settings = {});

}  // namespace innermap
