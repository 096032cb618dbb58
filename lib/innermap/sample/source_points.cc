#include "innermap/sample/source_points.h"

#include <fmt/format.h>

#include <cmath>

#include "innermap/core/parallel.h"
#include "innermap/core/random.h"
#include "innermap/levelset/offset_surface.h"
#include "innermap/sample/surface_samples.h"

namespace innermap {
namespace {

constexpr std::size_t kMaxSources = 10'000'000;

void checkCount(const SourceSettings& settings) {
  if (settings.count < 1 || settings.count > kMaxSources) {
    throw SettingError(
        "sources", fmt::format("must lie between 1 and {}, not {}", kMaxSources, settings.count));
  }
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

// Those of the shell's random samples [begin, end) that settle, in their order.
Points settledCandidates(const Solid& solid, const Mesh& shell, double distance, std::size_t begin,
                         std::size_t end, const SourceSettings& settings) {
  SampleSettings sampling;
  sampling.seed = settings.seed;
  sampling.progress = settings.progress;
  const std::vector<SurfacePoint> samples = randomSamples(shell, end, sampling);
  Points points(end - begin);
  std::vector<char> good(end - begin, 0);
  parallelBlocks(
      points.size(), 128,
      [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
          points[i] = positionOf(shell, samples[begin + i]);
          good[i] = settle(solid, shell, samples[begin + i].triangle, distance, points[i]);
        }
      },
      settings.progress, "placing sources");
  Points kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (good[i]) kept.push_back(points[i]);
  }
  return kept;
}

void requireOutside(const Solid& solid, const Points& points, double least, Progress* progress) {
  parallelBlocks(
      points.size(), 256,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const bool near = solid.closest(points[i], least).onSurface.triangle >= 0;
          if (near || solid.inside(points[i])) {
            throw DataError(
                fmt::format("source {} at ({:.6g}, {:.6g}, {:.6g}) stands inside the "
                            "solid or too near; choose another distance",
                            i, points[i].x, points[i].y, points[i].z));
          }
        }
      },
      progress);
}

}  // namespace

Points sourceShell(const Solid& solid, double distance, const SourceSettings& settings) {
  checkCount(settings);
  OffsetSettings offset;
  offset.distance = distance;
  offset.progress = settings.progress;
  const Mesh shell = offsetSurface(solid, offset);
  const double world = distance * solid.diagonal();
  const auto noRoom = [&] {
    return SettingError("distance", fmt::format("there is no room for {} sources at {:.4g} of the "
                                                "diagonal outside {}; choose another distance",
                                                settings.count, distance, solid.surface().name));
  };
  const double area = surfaceArea(shell);
  if (shell.triangles.empty() || !(area > 0)) throw noRoom();

  Points candidates;
  const std::size_t round = 5 * settings.count;
  std::size_t drawn = 0;
  for (int rounds = 0; rounds < 8 && candidates.size() < 4 * settings.count; ++rounds) {
    const Points more = settledCandidates(solid, shell, world, drawn, drawn + round, settings);
    candidates.insert(candidates.end(), more.begin(), more.end());
    drawn += round;
    if (drawn + round > 100'000'000) break;
  }
  if (candidates.size() < settings.count) throw noRoom();
  const double usable = area * static_cast<double>(candidates.size()) / static_cast<double>(drawn);
  Points points;
  points.reserve(settings.count);
  for (const std::size_t i : eliminateSamples(relativeTo(candidates, solid.box().center()),
                                              settings.count, usable, settings.progress)) {
    points.push_back(candidates[i]);
  }
  requireOutside(solid, points, 0.9 * world, settings.progress);
  return points;
}

Points sourceSphere(const Solid& solid, double ratio, const SourceSettings& settings) {
  checkCount(settings);
  if (!(ratio > 1 && ratio <= 100)) {
    throw SettingError("ratio", "must be over 1 and at most 100 (times half the diagonal)");
  }
  const CounterRandom random(settings.seed, 0x737068657265);
  Points candidates(5 * settings.count);
  parallelBlocks(
      candidates.size(), 4096,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const double z = 2 * random.uniform(2 * i) - 1;
          const double angle = 2 * 3.14159265358979323846 * random.uniform(2 * i + 1);
          const double r = std::sqrt(1 - z * z);
          candidates[i] = {r * std::cos(angle), r * std::sin(angle), z};
        }
      },
      settings.progress);
  const double area = 4 * 3.14159265358979323846;
  const double radius = 0.5 * ratio * solid.diagonal();
  const Vec3 center = solid.box().center();
  Points points;
  points.reserve(settings.count);
  for (const std::size_t i :
       eliminateSamples(candidates, settings.count, area, settings.progress)) {
    points.push_back(center + radius * candidates[i]);
  }
  requireOutside(solid, points, 0, settings.progress);
  return points;
}

}  // namespace innermap
