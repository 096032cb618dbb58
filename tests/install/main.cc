// Fits a harmonic map with the installed library: what `innermap fit` does, step by step.
#include <cstdio>

#include "innermap/core/error.h"
#include "innermap/field/boundary_error.h"
#include "innermap/field/harmonic_map.h"
#include "innermap/levelset/solid.h"
#include "innermap/mesh/read.h"
#include "innermap/sample/source_points.h"
#include "innermap/sample/surface_samples.h"
#include "innermap/solve/dense_solver.h"

namespace {

// Boundary points of the solid with the values of the map there.
struct Boundary {
  innermap::Points points;
  innermap::Matrix values;
};

Boundary boundaryAt(const innermap::Solid& solid, const innermap::Points& targetVertices,
                    const std::vector<innermap::SurfacePoint>& samples) {
  std::vector<innermap::SurfacePoint> addresses;
  for (const innermap::SurfacePoint& sample : samples) addresses.push_back(solid.address(sample));
  const innermap::Mesh& mesh = solid.repaired().mesh;
  const innermap::Points targets = interpolate(targetVertices, mesh.triangles, addresses);
  Boundary boundary{interpolate(mesh.vertices, mesh.triangles, addresses),
                    innermap::Matrix(targets.size(), 3)};
  for (std::size_t i = 0; i < targets.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) boundary.values(i, axis) = targets[i][axis];
  return boundary;
}

int fit(const char* sourcePath, const char* targetPath) {
  const innermap::Mesh source = innermap::readMesh(sourcePath);
  const innermap::Mesh target = innermap::readMeshLike(targetPath, source);
  const innermap::Solid solid(source);

  const innermap::Points charges = innermap::sourceShell(solid, 0.02, {500});
  const Boundary collocation =
      boundaryAt(solid, target.vertices, blueNoiseSamples(solid.surface(), 2000));
  const Boundary heldOut =
      boundaryAt(solid, target.vertices, randomSamples(solid.surface(), 1000, {2}));
  const Boundary fresh =
      boundaryAt(solid, target.vertices, randomSamples(solid.surface(), 20000, {3}));

  const innermap::DenseSolver solver(collocation.points, charges, heldOut.points);
  const innermap::DenseSolution solution =
      solver.solve(collocation.values, innermap::Regularization::tikhonov, heldOut.values);
  const innermap::HarmonicMap map(
      innermap::HarmonicField(charges, solution.weights, solution.affine));

  const innermap::BoundaryError error =
      measureBoundaryError(map.field(), fresh.points, fresh.values, boundingBox(target).diagonal());
  std::printf("boundary error: rms %.2g, 99%% %.2g, largest %.2g of the diagonal\n", error.rms,
              error.p99, error.max);
  return error.rms < 3e-3 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  try {
    return fit(argv[1], argv[2]);
  } catch (const innermap::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
