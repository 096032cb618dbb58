#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>

#include "core/require_number.h"
#include "innermap/core/run.h"
#include "innermap/tetra/hexahedralize.h"
#include "mesh/triangle_tree.h"
#include "sample/surface_samples.h"

namespace innermap {
namespace {

constexpr char kComparing[] = "comparing the boundaries";
constexpr double kAnywhere = std::numeric_limits<double>::infinity();

SurfaceDistance distanceOf(const Mesh& from, double diagonal, const BoundaryFitSettings& settings,
                           const std::function<double(const Vec3&)>& distance) {
  SampleSettings sampling;
  sampling.seed = settings.seed;
  const std::vector<SurfacePoint> samples = randomSamples(from, settings.samples, sampling);
  std::vector<double> found(samples.size());
  parallelBlocks(
      samples.size(), 64,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          found[i] = distance(positionOf(from, samples[i])) / diagonal;
      },
      kComparing);
  SurfaceDistance result;
  for (const double d : found) {
    result.rms += d * d;
    result.max = std::max(result.max, d);
  }
  result.rms = std::sqrt(result.rms / static_cast<double>(found.size()));
  return result;
}

std::size_t inwardFaces(const Mesh& boundary, const Solid& solid) {
  std::atomic<std::size_t> count{0};
  parallelBlocks(
      boundary.triangles.size(), 64,
      [&](std::size_t begin, std::size_t end) {
        std::size_t own = 0;
        for (std::size_t t = begin; t < end; ++t) {
          const Triangle& c = boundary.triangles[t];
          const Vec3 middle =
              (boundary.vertices[c[0]] + boundary.vertices[c[1]] + boundary.vertices[c[2]]) / 3;
          const Solid::Closest closest = solid.closest(middle, kAnywhere);
          own += dot(areaVector(boundary, static_cast<int>(t)),
                     areaVector(solid.surface(), closest.onSurface.triangle)) < 0;
        }
        count += own;
      },
      kComparing);
  return count;
}

}  // namespace

BoundaryFit boundaryFit(const CellMesh& mesh, const Solid& solid,
                        const BoundaryFitSettings& settings) {
  requireNumber("samples", settings.samples, {1});
  Mesh boundary;
  boundary.name = "boundary of " + mesh.name;
  boundary.vertices = mesh.vertices;
  boundary.triangles = settings.boundary && !settings.boundary->empty() ? *settings.boundary
                                                                        : boundaryTriangles(mesh);
  const TriangleTree tree(boundary.vertices, boundary.triangles);
  BoundaryFit fit;
  fit.faces = boundary.triangles.size();
  fit.toSurface = distanceOf(boundary, solid.diagonal(), settings,
                             [&](const Vec3& p) { return solid.distance(p); });
  fit.fromSurface = distanceOf(solid.surface(), solid.diagonal(), settings,
                               [&](const Vec3& p) { return tree.closest(p).distance; });
  fit.inward = inwardFaces(boundary, solid);
  return fit;
}

}  // namespace innermap
