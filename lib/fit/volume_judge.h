// Which of several maps between two surfaces does least harm to the inside.
//
// Surface energies do not tell: least of them, a cow's ears go to a man's feet. The harmonic map of
// the inside that a surface map gives does, and a coarse one is cheap: charges are placed and
// factored once for a surface, each map of it is a right-hand side.
#pragma once

#include <vector>

#include "innermap/solve/solver.h"
#include "innermap/surface/correspond.h"

namespace innermap {

class VolumeJudge {
 public:
  // surface: closed and outward. targetVolume: world units cubed, above 0. Throws DataError where
  // there is no inside or no room for charges; Cancelled.
  VolumeJudge(const ClosedSurface& surface, double targetVolume);

  // Points of the surface whose images are judged.
  const std::vector<SurfacePoint>& at() const { return at_; }

  // images: of at(), world units of the target. Mean over points inside of the sum of squared
  // logarithms of the stretches (both solids scaled to one volume), which are taken as 0.02 at
  // least, plus 20 where the map is turned inside out: 0 for a similarity, less is better. Safe
  // from any number of threads.
  double score(const Points& images) const;

 private:
  struct Placed;
  explicit VolumeJudge(Placed placed);

  std::vector<SurfacePoint> at_;
  Points sources_, inside_;
  DenseSolver solver_;
  double scale_ = 1;  // from target to source, of lengths
};

}  // namespace innermap
