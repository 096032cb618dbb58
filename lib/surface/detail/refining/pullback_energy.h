// How much a map between two surfaces stretches, both ways.
#pragma once

#include <vector>

#include "innermap/surface/correspond.h"
#include "surface/detail/refining/coarse_to_fine.h"
#include "surface/detail/refining/rest_triangle.h"
#include "surface/detail/refining/target_metric.h"

namespace innermap {

// Symmetric Dirichlet energy of the map A -> model space -> B over A's area plus over B's, both
// areas 1 (8 for an isometry), summed at points spread over A's triangles: the metric of B is
// pulled back to the model space there, so flips in the space are the only barrier. Schmidt,
// Campen, Born, Kobbelt, "Inter-surface maps via constant-curvature metrics" (SIGGRAPH 2020);
// Takayama, "Compatible intrinsic triangulations" (SIGGRAPH 2022).
class PullbackEnergy : public StarEnergy {
 public:
  // All must outlive it; `image` is the layout of `mesh`'s vertices on the target's space. Summed
  // at `samples` points of all triangles or more.
  PullbackEnergy(const ClosedSurface& source, const ProgressiveMesh& mesh, const Layout& image,
                 const TargetMetric& target, double samples);

  void grown(std::size_t vertices) override;
  void changed(int triangle) override;
  std::unique_ptr<Star> star() const override;

  // Of one triangle; of all that stand.
  double ofTriangle(int t) const;
  double total() const;

 private:
  class PullbackStar;
  struct StarTriangle {
    Vec3 a, b;
    double cotFree, cotA, cotB, area;
  };
  // `where`: any place near by, and the last one found. `found`: where each sample was found
  // before, or triangle -1; where it is now. Infinite where the energy is above `most`.
  double of(const StarTriangle& t, const Vec3& place, Located& where, Located* found,
            double most) const;
  StarTriangle starTriangle(int t, int corner) const;

  const ProgressiveMesh& mesh_;
  const Layout& image_;
  const TargetMetric& target_;
  Points points_;
  double samplesWanted_;
  double slack_ = 0;
  std::vector<Vec2> samples_;  // weights of the second and third corner, next to one another
  std::vector<RestTriangle> rest_;
};

// Centroids of a triangle's m^2 congruent parts, back and forth.
std::vector<Vec2> triangleSamples(int m);

}  // namespace innermap
