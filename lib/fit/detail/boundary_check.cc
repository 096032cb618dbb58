#include "fit/detail/boundary_check.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "fit/detail/inside_check.h"
#include "fit/detail/refined_surface.h"
#include "fit/detail/streams.h"
#include "innermap/core/run.h"
#include "mesh/connectivity.h"
#include "sample/surface_samples.h"

namespace innermap {
namespace {

constexpr std::size_t kBoundary = 10000, kFewTriangles = 10000;
constexpr double kInTarget = 2000;
// Volume over the diagonal's cube, for the lattice's spacing.
constexpr double kThinnestSolid = 0.01;
constexpr double kSumAccuracy = 1e-7;  // of the target's diagonal

SolidFigures figuresOf(const Solid& solid) {
  const Mesh& mesh = solid.repaired().mesh;
  const std::vector<int> pieces = piecesByEdges(joinedTriangles(mesh.vertices, mesh.triangles));
  const Vec3 center = solid.box().center();
  std::map<int, double> volumes;
  for (std::size_t t = 0; t < pieces.size(); ++t) {
    const Triangle& corners = mesh.triangles[t];
    volumes[pieces[t]] +=
        dot(mesh.vertices[corners[0]] - center,
            cross(mesh.vertices[corners[1]] - center, mesh.vertices[corners[2]] - center));
  }
  SolidFigures out;
  out.surfaces = volumes.size();
  const auto parts = std::count_if(volumes.begin(), volumes.end(),
                                   [](const auto& volume) { return volume.second > 0; });
  out.parts = std::max<std::size_t>(1, static_cast<std::size_t>(parts));
  out.caps = static_cast<std::size_t>(solid.repaired().caps);
  out.overlaps = solid.overlaps();
  return out;
}

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

Injectivity injectivityOf(const BoundaryPair& pair) {
  Injectivity out;
  out.mirrored = orientationOf(pair.solid(), pair.target) < 0;
  out.solid = figuresOf(pair.solid());
  out.source = selfIntersectionFigures(pair.source.check);
  out.target = selfIntersectionFigures(pair.targetCheck);
  return out;
}

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
  const double volume = std::max(target.volume(), kThinnestSolid * std::pow(box.diagonal(), 3));
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

void checkBoundary(const ComposedMap& map, const BoundaryPair& pair, const TargetShape& target,
                   double error, std::uint64_t seed, Injectivity& known) {
  BoundaryCheckSettings s;
  s.error = error * pair.target.diagonal;
  s.accuracy = kSumAccuracy * pair.target.diagonal;
  s.seed = seed;
  known.boundaryError = error;
  known.boundary = boundaryDeterminants(map, pair, target, s);
  known.degree = boundaryDegree(map, pair, target, s);
}

}  // namespace innermap
