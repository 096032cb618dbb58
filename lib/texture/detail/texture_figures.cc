#include "texture/detail/texture_figures.h"

#include <openvdb/tools/Interpolation.h>

#include <algorithm>
#include <cmath>

#include "core/point_grid.h"
#include "innermap/core/run.h"
#include "sample/surface_samples.h"

namespace innermap {
namespace {

constexpr std::size_t kSamples = 20000;
constexpr std::size_t kMostEdgeSamples = 200000;

// Points along the segments, no farther apart than `step`.
Points alongSegments(const std::vector<Segment>& segments, double step) {
  double length = 0;
  for (const Segment& s : segments) length += norm(s.to - s.from);
  const double apart = std::max(step, length / static_cast<double>(kMostEdgeSamples));
  Points points;
  for (const Segment& s : segments) {
    const int count = std::max(1, static_cast<int>(std::ceil(norm(s.to - s.from) / apart)));
    for (int i = 0; i < count; ++i)
      points.push_back(s.from + ((i + 0.5) / count) * (s.to - s.from));
  }
  return points;
}

BoundaryError summaryOf(std::vector<double> lengths) {
  return lengths.empty() ? BoundaryError() : summarizeErrors(std::move(lengths));
}

std::vector<SurfacePoint> freshPoints(const Solid& solid, std::uint64_t seed) {
  SampleSettings settings;
  settings.seed = seed;
  return randomSamples(solid.surface(), kSamples, settings);
}

}  // namespace

std::vector<Segment> segmentsOf(const Mesh& mesh, const std::vector<UvSeam>& seams) {
  std::vector<Segment> segments;
  for (const UvSeam& s : seams) {
    const Triangle& t = mesh.triangles[s.triangle];
    segments.push_back({mesh.vertices[t[s.corner]], mesh.vertices[t[(s.corner + 1) % 3]]});
  }
  return segments;
}

std::uint64_t voxelsAlong(const std::vector<Segment>& segments,
                          const openvdb::FloatGrid& levelSet) {
  if (segments.empty()) return 0;
  return voxelsNear(segments, levelSet, kSeamReach * levelSet.voxelSize()[0])->activeVoxelCount();
}

double areaShareAlong(const std::vector<Segment>& segments, const Solid& solid, double voxel) {
  const PointGrid along(alongSegments(segments, 0.25 * voxel), kSeamReach * voxel);
  std::size_t near = 0;
  for (const SurfacePoint& p : freshPoints(solid, 1))
    if (along.anyNearer(positionOf(solid.surface(), p), kSeamReach * voxel)) ++near;
  return static_cast<double>(near) / static_cast<double>(kSamples);
}

BoundaryError seamDifferences(const Mesh& mesh, const UvCharts& charts,
                              const SurfaceTexture& surface, double voxel) {
  std::vector<double> out;
  const double step = std::max(voxel, charts.seamLength / static_cast<double>(kMostEdgeSamples));
  for (const UvSeam& s : charts.seams) {
    const Triangle &a = mesh.triangles[s.triangle], &b = mesh.triangles[s.other];
    const Vec3 from = mesh.vertices[a[s.corner]], to = mesh.vertices[a[(s.corner + 1) % 3]];
    const Vec3 otherFrom = mesh.vertices[b[s.otherCorner]];
    const bool opposite = norm(otherFrom - to) < norm(otherFrom - from);
    const int count = std::max(1, static_cast<int>(std::ceil(norm(to - from) / step)));
    for (int i = 0; i < count; ++i) {
      const double t = (i + 0.5) / count;
      const Vec3 here = surface.colourOnEdge(s.triangle, s.corner, t, voxel),
                 there = surface.colourOnEdge(s.other, s.otherCorner, opposite ? 1 - t : t, voxel);
      out.push_back(norm(here - there));
    }
  }
  return summaryOf(std::move(out));
}

ColourErrors colourErrors(const Solid& solid, const std::vector<Segment>& seams,
                          const SurfaceTexture& surface, const openvdb::Vec3fGrid& colour,
                          std::uint64_t seed) {
  const double voxel = colour.voxelSize()[0];
  const std::vector<SurfacePoint> points = freshPoints(solid, seed);
  const PointGrid along(alongSegments(seams, 0.25 * voxel), kSeamReach * voxel);
  std::vector<double> errors(points.size());
  std::vector<char> onSeam(points.size(), 0);
  parallelBlocks(points.size(), 256, [&](std::size_t begin, std::size_t end) {
    const auto access = colour.getConstAccessor();  // the sampler keeps a pointer to it
    const openvdb::tools::GridSampler<openvdb::Vec3fGrid::ConstAccessor, openvdb::tools::BoxSampler>
        sampler(access, colour.transform());
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 p = positionOf(solid.surface(), points[i]);
      const openvdb::Vec3f c = sampler.wsSample(openvdb::Vec3d(p.x, p.y, p.z));
      errors[i] = norm(Vec3{c[0], c[1], c[2]} - surface.colour(points[i], voxel));
      onSeam[i] = along.anyNearer(p, kSeamReach * voxel);
    }
  });
  std::vector<double> seamErrors;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (onSeam[i]) seamErrors.push_back(errors[i]);
  return {summaryOf(std::move(errors)), summaryOf(std::move(seamErrors))};
}

}  // namespace innermap
