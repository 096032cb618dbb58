#include "surface/detail/refining/coarse_to_fine.h"

#include <gtest/gtest.h>

#include "innermap/core/run.h"
#include "mesh/shapes.h"
#include "surface/detail/refining/decimate.h"
#include "surface/detail/refining/pullback_energy.h"
#include "surface/detail/sphere/sphere_layout.h"
#include "surface/handle_shapes.h"

namespace innermap {
namespace {

// A bent ellipsoid's vertices on the layout of a ball, coarsened to a few and refined again.
Points refined(bool parallel) {
  const ClosedSurface ball = shapes::closed(shapes::icosphere(3), 0);
  ClosedSurface bent = ball;
  for (Vec3& p : bent.vertices) p = {2 * p.x, p.y + p.x * p.x, 0.7 * p.z};
  Layout image = layOutSphere(bent);
  ProgressiveMesh mesh(bent.vertices.size(), bent.triangles);
  DecimateSettings coarse;
  coarse.vertices = 40;
  coarse.layout = &image;
  decimate(mesh, bent.vertices, coarse);
  const TargetMetric target(ball, layOutSphere(ball));
  PullbackEnergy energy(bent, mesh, image, target, 3000);
  RelaxSettings relax;
  relax.parallel = parallel;
  CoarseToFine fine(mesh, image, energy, {}, relax);
  fine.relaxAll(3);
  EXPECT_EQ(fine.refine(bent.vertices.size()), -1);
  return image.place;
}

TEST(CoarseToFine, VerticesAtTheSameTimeMoveAsOneAfterTheOther) {
  const Points one = refined(false);
  for (const int threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    const Points many = refined(true);
    for (std::size_t v = 0; v < one.size(); ++v)
      ASSERT_EQ(norm(many[v] - one[v]), 0) << threads << " threads, vertex " << v;
  }
}

}  // namespace
}  // namespace innermap
