// How good a map between two surfaces is.
#pragma once

#include <cstddef>

#include "innermap/surface/correspond.h"

namespace innermap {

struct Quantiles {
  double median = 0, p99 = 0, max = 0;
};

// Both solids' shells scaled to unit area together, so a map that keeps all lengths but for one
// factor has energies 4 and stretch 1.
struct MapQuality {
  // On the model spaces, over all shells; with no flip and degree 1 the map is one-to-one.
  std::size_t flips = 0;      // triangles of A's images and of B's layouts
  double degree = 0;          // of the image farthest from degree 1
  double areaRatioLog10 = 0;  // least log10 of an image triangle's share of the model space over
                              // its share of A

  // Mean of the symmetric Dirichlet energy s1^2 + s2^2 + 1/s1^2 + 1/s2^2 of the map A -> B (s1, s2:
  // its singular values) over A's area, and over B's: at least 4 each.
  double energyForward = 0, energyBackward = 0;
  // max(s1, 1/s2) of the map A -> B, weighted by A's area. The map is the one through the model
  // space, which covers B exactly.
  Quantiles stretch;
  // The same of A's triangles onto the flat triangles between their moved vertices, 1e12 at most.
  Quantiles triangleStretch;
  double unmeasured = 0;  // share of the samples that fell on slivers (a height under a millionth
                          // of the longest edge), which have no meaningful derivative

  // Image triangles that face against B at all three corners and in the middle.
  std::size_t invertedTriangles = 0;
  double invertedShare = 0;  // of all triangles

  // Distance of the flat image triangles from B, and of B from them; shares of B's diagonal,
  // weighted by area.
  Quantiles deviation, backDeviation;

  // Pairs of triangles that pass through each other.
  std::size_t imageSelfIntersections = 0, targetSelfIntersections = 0;
};

struct MapQualitySettings {
  std::size_t samples = 100000;  // on each surface, spread by area; in [1, 1e8]. Each triangle has
                                 // one at least
  bool selfIntersections = true;
};

// Same result for any number of threads. Throws SettingError, Cancelled.
MapQuality mapQuality(const Correspondence& map, const MapQualitySettings& settings = {});

}  // namespace innermap
