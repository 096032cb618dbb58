#include "sample/surface_samples.h"

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "sample/detail/sample_elimination.h"

namespace innermap {
namespace {

constexpr std::uint64_t kStream = 0x73616d706c65;
constexpr std::size_t kMaxSamples = 100'000'000;
constexpr std::size_t kBlock = 4096;

// Candidates for each sample that is kept: Yuksel's recommendation, less where memory would hurt.
std::size_t candidatesFor(std::size_t count) { return count * (count <= 2'000'000 ? 5 : 3); }

std::vector<double> cumulativeAreas(const Mesh& mesh) {
  std::vector<double> cumulative;
  cumulative.reserve(mesh.triangles.size());
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    cumulative.push_back(sum += norm(areaVector(mesh, static_cast<int>(t))));
  }
  if (!(sum > 0) || !std::isfinite(sum)) {
    throw DataError(mesh.name + ": has no surface area to place samples on");
  }
  for (double& c : cumulative) c /= sum;
  return cumulative;
}

}  // namespace

std::vector<SurfacePoint> randomSamples(const Mesh& mesh, std::size_t count,
                                        const SampleSettings& settings) {
  requireNumber("samples", count, {0, kMaxSamples});
  const std::vector<double> cumulative = cumulativeAreas(mesh);
  const CounterRandom random(settings.seed, kStream);
  std::vector<SurfacePoint> samples(count);
  parallelBlocks(count, kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double u = random.uniform(3 * i);
      // The first triangle whose sum exceeds u: never one without area.
      std::size_t t =
          std::upper_bound(cumulative.begin(), cumulative.end(), u) - cumulative.begin();
      if (t == cumulative.size()) {
        t = std::lower_bound(cumulative.begin(), cumulative.end(), cumulative.back()) -
            cumulative.begin();
      }
      const double r = std::sqrt(random.uniform(3 * i + 1)), s = random.uniform(3 * i + 2);
      samples[i] = {static_cast<int>(t), {1 - r, r * (1 - s), r * s}};
    }
  });
  return samples;
}

std::vector<SurfacePoint> blueNoiseSamples(const Mesh& mesh, std::size_t count,
                                           const SampleSettings& settings) {
  requireNumber("samples", count, {0, kMaxSamples / 5.0});
  const std::vector<SurfacePoint> candidates = randomSamples(mesh, candidatesFor(count), settings);
  Points points(candidates.size());
  // About the centre: positions far from the origin lose digits that distances need.
  const Vec3 center = boundingBox(mesh).center();
  parallelBlocks(candidates.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Triangle& t = mesh.triangles[candidates[i].triangle];
      Vec3 p;
      for (int k = 0; k < 3; ++k) {
        p += candidates[i].barycentric[k] * (mesh.vertices[t[k]] - center);
      }
      points[i] = p;
    }
  });
  const std::vector<std::size_t> kept = eliminateSamples(points, count, surfaceArea(mesh));
  std::vector<SurfacePoint> samples;
  samples.reserve(kept.size());
  for (const std::size_t i : kept) samples.push_back(candidates[i]);
  return samples;
}

}  // namespace innermap
