#include "sample/source_points.h"

#include <fmt/format.h>

#include <cmath>

#include "core/pi.h"
#include "core/random.h"
#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "levelset/offset_surface.h"
#include "sample/detail/sample_elimination.h"
#include "sample/surface_samples.h"

namespace innermap {
namespace {

constexpr double kMaxSources = 10'000'000;

void checkCount(const SourceSettings& settings) {
  requireNumber("charges", static_cast<double>(settings.count), {1, kMaxSources});
}

Points relativeTo(Points points, const Vec3& center) {
  for (Vec3& p : points) p = p - center;
  return points;
}

// Moves a sample of triangle `t` of the shell to `distance` from the surface; false where it stays
// nearer than 0.97 of it (in a crease between parts) or comes to lie inside.
bool settle(const Solid& solid, const Mesh& shell, int t, double distance, Vec3& p) {
  const double error = moveToDistance(solid, distance, p);
  if (!(error <= 0.03 * distance)) return false;
  // The shell's vertices are outside. When the balls about one of them and about p that are free
  // of surface meet, so is p.
  const double reach = 1.9 * distance - 2 * solid.gap();
  for (const int v : shell.triangles[t]) {
    if (norm(shell.vertices[v] - p) < reach) return true;
  }
  return !solid.inside(p);
}

// Those of the samples that settle, in their order.
Points settled(const Solid& solid, const Mesh& shell, double distance,
               const std::vector<SurfacePoint>& samples) {
  Points points(samples.size());
  std::vector<char> good(samples.size(), 0);
  parallelBlocks(
      points.size(), 128,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          points[i] = positionOf(shell, samples[i]);
          good[i] = settle(solid, shell, samples[i].triangle, distance, points[i]);
        }
      },
      "placing sources");
  Points kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (good[i]) kept.push_back(points[i]);
  }
  return kept;
}

// At least `count` settled points spread evenly over the shell, few more than that, or all that
// there are. Settling takes longest, so random samples are thinned before; a probe says what share
// of them settles, for only in creases some do not.
Points settledEvenly(const Solid& solid, const Mesh& shell, double distance,
                     const SourceSettings& settings) {
  constexpr std::size_t kProbe = 1000, kMostRounds = 8;
  constexpr double kReserve = 1.02, kMore = 1.3;
  SampleSettings sampling;
  sampling.seed = settings.seed;
  const std::size_t probed = std::min(kProbe, 5 * settings.count);
  const Points probe = settled(solid, shell, distance, randomSamples(shell, probed, sampling));
  const double share = static_cast<double>(probe.size() + 1) / static_cast<double>(probed + 1);
  const auto rounds =
      std::clamp<std::size_t>(static_cast<std::size_t>(0.8 / share + 1), 1, kMostRounds);
  const std::vector<SurfacePoint> samples = randomSamples(
      shell, std::min<std::size_t>(5 * settings.count * rounds, 100'000'000), sampling);
  const Points places =
      relativeTo(interpolate(shell.vertices, shell.triangles, samples), solid.box().center());
  for (double most = 8 + kReserve * static_cast<double>(settings.count) / share;; most *= kMore) {
    std::vector<SurfacePoint> even;
    const std::size_t wanted = most < static_cast<double>(samples.size())
                                   ? static_cast<std::size_t>(most)
                                   : samples.size();
    for (const std::size_t i : eliminateSamples(places, wanted, surfaceArea(shell))) {
      even.push_back(samples[i]);
    }
    Points points = settled(solid, shell, distance, even);
    if (points.size() >= settings.count || wanted == samples.size()) return points;
  }
}

void requireOutside(const Solid& solid, const Points& points, double least) {
  parallelBlocks(points.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const bool near = solid.closest(points[i], least).onSurface.triangle >= 0;
      if (near || solid.inside(points[i])) {
        throw DataError(
            fmt::format("source {} at ({:.6g}, {:.6g}, {:.6g}) stands inside the "
                        "solid or too near; choose another distance",
                        i, points[i].x, points[i].y, points[i].z));
      }
    }
  });
}

}  // namespace

Points sourceShell(const Solid& solid, double distance, const SourceSettings& settings) {
  checkCount(settings);
  OffsetSettings offset;
  offset.distance = distance;
  const Mesh shell = offsetSurface(solid, offset);
  const double world = distance * solid.diagonal();
  const auto noRoom = [&] {
    return SettingError("distance", fmt::format("there is no room for {} sources at {:.4g} of the "
                                                "diagonal outside {}; choose another distance",
                                                settings.count, distance, solid.surface().name));
  };
  const double area = surfaceArea(shell);
  if (shell.triangles.empty() || !(area > 0)) throw noRoom();

  const Points candidates = settledEvenly(solid, shell, world, settings);
  if (candidates.size() < settings.count) throw noRoom();
  Points points;
  points.reserve(settings.count);
  for (const std::size_t i :
       eliminateSamples(relativeTo(candidates, solid.box().center()), settings.count, area)) {
    points.push_back(candidates[i]);
  }
  requireOutside(solid, points, 0.9 * world);
  return points;
}

Points sourceSphere(const Solid& solid, double ratio, const SourceSettings& settings) {
  checkCount(settings);
  requireNumber("ratio", ratio, {1, 100, true}, "times half the diagonal");
  const CounterRandom random(settings.seed, 0x737068657265);
  Points candidates(5 * settings.count);
  parallelBlocks(candidates.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double z = 2 * random.uniform(2 * i) - 1;
      const double angle = 2 * kPi * random.uniform(2 * i + 1);
      const double r = std::sqrt(1 - z * z);
      candidates[i] = {r * std::cos(angle), r * std::sin(angle), z};
    }
  });
  const double area = 4 * kPi;
  const double radius = 0.5 * ratio * solid.diagonal();
  const Vec3 center = solid.box().center();
  Points points;
  points.reserve(settings.count);
  for (const std::size_t i : eliminateSamples(candidates, settings.count, area)) {
    points.push_back(center + radius * candidates[i]);
  }
  requireOutside(solid, points, 0);
  return points;
}

}  // namespace innermap
