#include "fit/detail/boundary_check.h"

#include <algorithm>
#include <cmath>

#include "fit/detail/inside_check.h"
#include "fit/detail/refined_surface.h"
#include "fit/detail/streams.h"
#include "innermap/core/run.h"
#include "sample/surface_samples.h"

namespace innermap {
namespace {

constexpr std::size_t kBoundary = 10000, kFewTriangles = 10000;
constexpr double kInTarget = 2000;
constexpr double kThinnest = 0.01;  // volume over the diagonal's cube, for the lattice's spacing

Points imagesOf(const ComposedMap& map, const Points& points,
                const BoundaryCheckSettings& settings) {
  EvaluateFieldSettings sums;
  sums.accuracy = settings.accuracy;
  const Matrix values = map.evaluate(points, sums).values;
  Points out(points.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = {values(i, 0), values(i, 1), values(i, 2)};
  return out;
}

WindingNumber imageOf(const ComposedMap& map, const Mesh& surface,
                      const BoundaryCheckSettings& settings) {
  RefinedSurface refined(surface);
  Points images = imagesOf(map, surface.vertices, settings);
  EdgeImages edges;
  refine(
      refined, images, edges,
      [&](const std::vector<SurfacePoint>& places) {
        return imagesOf(map, interpolate(surface.vertices, surface.triangles, places), settings);
      },
      settings.error, kFewTriangles);
  return {images, refined.triangles};
}

}  // namespace

DeterminantFigures boundaryDeterminants(const ComposedMap& map, const BoundaryPair& pair,
                                        const TargetShape& target,
                                        const BoundaryCheckSettings& settings) {
  SampleSettings sample;
  sample.seed = seedOf(settings.seed, Stream::fresh);
  const Mesh& surface = pair.solid().surface();
  return determinantsOf(mapPoints(map,
                                  interpolate(surface.vertices, surface.triangles,
                                              randomSamples(surface, kBoundary, sample)),
                                  settings.accuracy),
                        target, settings.error);
}

DegreeFigures boundaryDegree(const ComposedMap& map, const BoundaryPair& pair,
                             const TargetShape& target, const BoundaryCheckSettings& settings) {
  const WindingNumber image = imageOf(map, pair.solid().surface(), settings);
  const Box3 box = boundingBox(pair.target.mesh(pair.solid(), ""));
  const double volume = std::max(target.volume(), kThinnest * std::pow(box.diagonal(), 3));
  Points deep =
      stratifiedPoints(box, std::cbrt(volume / kInTarget),
                       {[&](const Vec3& p) { return target.inside(p); },
                        [&](const Vec3& p, double distance) { return target.near(p, distance); }});
  deep.erase(std::remove_if(deep.begin(), deep.end(),
                            [&](const Vec3& p) { return target.near(p, settings.error); }),
             deep.end());
  std::vector<int> windings(deep.size());
  parallelBlocks(deep.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      windings[i] = target.orientation() * static_cast<int>(std::lround(image.at(deep[i])));
  });
  DegreeFigures out;
  out.checked = deep.size();
  if (deep.empty()) return out;
  const auto [least, greatest] = std::minmax_element(windings.begin(), windings.end());
  out.least = *least;
  out.greatest = *greatest;
  return out;
}

}  // namespace innermap
