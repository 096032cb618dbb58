// From the map of a coarsened surface to that of all its vertices.
#pragma once

#include <string>
#include <vector>

#include "surface/detail/refining/coarse_map.h"
#include "surface/detail/refining/coarse_to_fine.h"
#include "surface/detail/refining/pullback_energy.h"

namespace innermap {

struct RefineSettings {
  std::vector<char> fixed;  // #V of the fine surface or empty: vertices that stay where they are
  bool relax = true;        // otherwise vertices return to where their rings let them, no more
};

// The vertices there are, and where the map has them.
struct RefinedSoFar {
  CoarseSurface surface;
  Layout image;
};

// Vertices return one by one, each and its ring lowering the energy; all when the mesh has grown by
// half. References must outlive it; it cannot be copied or moved.
class MapRefiner {
 public:
  // `mesh` is the fine surface's, coarsened as `coarse` was made of it.
  MapRefiner(const ClosedSurface& surface, const ProgressiveMesh& mesh, const CoarseSurface& coarse,
             const CoarseMap& start, const TargetMetric& target, const RefineSettings& settings);
  MapRefiner(const MapRefiner&) = delete;
  MapRefiner& operator=(const MapRefiner&) = delete;

  // Until so many vertices are there; false where rounding leaves no place for some vertex.
  bool refineTo(std::size_t vertices);

  double energy() const { return energy_.total(); }
  const std::string& origin() const { return origin_; }
  // Sphere only.
  RefinedSoFar soFar() const;
  // Of the fine surface, once all vertices are there.
  Layout takeImage();

 private:
  static Layout startImage(const ClosedSurface& surface, const CoarseSurface& coarse,
                           const CoarseMap& start);

  const ClosedSurface& surface_;
  ProgressiveMesh mesh_;
  Layout image_;
  PullbackEnergy energy_;
  CoarseToFine fine_;
  std::string origin_;
};

}  // namespace innermap
