#include "innermap/surface/detail/refining/shell_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <numeric>

#include "innermap/core/error.h"
#include "innermap/core/parallel.h"
#include "innermap/surface/detail/refining/decimate.h"
#include "innermap/surface/detail/refining/layout_map.h"
#include "innermap/surface/detail/refining/map_refiner.h"
#include "innermap/surface/detail/sphere/sphere_candidates.h"
#include "innermap/surface/detail/sphere/sphere_layout.h"
#include "innermap/surface/detail/torus/torus_candidates.h"
#include "innermap/surface/detail/torus/torus_layout.h"

namespace innermap {
namespace {

constexpr std::size_t kTried = 10;    // candidates that are refined to
constexpr std::size_t kJudged = 40;   // first maps that a judge hears
constexpr std::size_t kMiddle = 600;  // vertices before the best are chosen
constexpr std::size_t kCoarse = 150;
// Of B, while first maps are looked for: these have triangles far larger, and finding places among
// B's own is most of the work.
constexpr std::size_t kCoarseTarget = 2000;

Layout layOut(const ClosedSurface& surface, Progress* progress) {
  if (surface.genus == 1) return layOutTorus(surface, progress);
  SphereLayoutSettings settings;
  settings.progress = progress;
  return layOutSphere(surface, settings);
}

using Refiners = std::vector<std::unique_ptr<MapRefiner>>;

// Refines all to so many vertices; those that get stuck are left out, the best come first.
void refineAll(Refiners& refiners, std::size_t vertices, Progress* progress) {
  std::vector<double> energy(refiners.size());
  std::vector<char> good(refiners.size(), 0);
  parallelBlocks(
      refiners.size(), 1,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          good[i] = refiners[i]->refineTo(vertices);
          energy[i] = refiners[i]->energy();
        }
      },
      progress);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < refiners.size(); ++i)
    if (good[i]) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t x, std::size_t y) { return energy[x] < energy[y]; });
  Refiners out;
  for (const std::size_t i : order) out.push_back(std::move(refiners[i]));
  refiners = std::move(out);
}

// Images of a judge's points by a layout of A's shell on B's model space.
Points imagesOf(const std::vector<SurfacePoint>& points, const ClosedSurface& surface,
                const Layout& image, const LaidOutShell& b, const Locator& onB) {
  const Locator none(surface.triangles, image);
  const LayoutMap map({surface, image, none}, {b.surface, b.layout, onB});
  Points out;
  for (const SurfacePoint& p : points) out.push_back(map.at(p.triangle, p.barycentric).position);
  return out;
}

// The judge's points on the coarse surface, by A's own layout.
std::vector<SurfacePoint> onCoarse(const std::vector<SurfacePoint>& points, const LaidOutShell& a,
                                   const CoarseSurface& coarse) {
  Layout own = a.layout;
  own.place.clear();
  for (const int v : coarse.vertex) own.place.push_back(a.layout.place[v]);
  const Locator locator(coarse.surface.triangles, own);
  std::vector<SurfacePoint> out;
  for (const SurfacePoint& p : points) {
    Vec3 ray;
    for (int k = 0; k < 3; ++k)
      ray += p.barycentric[k] * a.layout.corner(a.surface.triangles, p.triangle, k);
    ray = ray / norm(ray);
    const Located where = locator.find(ray);
    out.push_back({where.triangle, locator.barycentric(ray, where)});
  }
  return out;
}

// Orders first maps by the judge's score.
std::vector<ConsideredMap> judged(Candidates& candidates, const LaidOutShell& a,
                                  const LaidOutShell& b, const ShellMapSettings& settings) {
  const std::vector<SurfacePoint> points = onCoarse(settings.judge->at, a, candidates.coarse);
  const Locator onB(b.surface.triangles, b.layout);
  std::vector<double> score(candidates.maps.size());
  parallelBlocks(
      score.size(), 1,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          score[i] = settings.judge->score(
              imagesOf(points, candidates.coarse.surface, candidates.maps[i].image, b, onB));
      },
      settings.progress, "judging first maps");
  std::vector<std::size_t> order(score.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t x, std::size_t y) { return score[x] < score[y]; });
  std::vector<ConsideredMap> out;
  std::vector<CoarseMap> maps;
  for (const std::size_t i : order) {
    out.push_back({candidates.maps[i].origin, candidates.maps[i].energy, score[i]});
    maps.push_back(std::move(candidates.maps[i]));
  }
  candidates.maps = std::move(maps);
  return out;
}

// Of maps of spheres refined so far, the one that the judge likes best alone: what it sees does not
// change much any more.
void keepBest(Refiners& refiners, const LaidOutShell& a, const LaidOutShell& b,
              const ShellMapSettings& settings) {
  const Locator onB(b.surface.triangles, b.layout);
  std::vector<double> score(refiners.size());
  parallelBlocks(
      score.size(), 1,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const RefinedSoFar map = refiners[i]->soFar();
          score[i] = settings.judge->score(imagesOf(onCoarse(settings.judge->at, a, map.surface),
                                                    map.surface.surface, map.image, b, onB));
        }
      },
      settings.progress);
  const auto best = std::min_element(score.begin(), score.end()) - score.begin();
  std::swap(refiners.front(), refiners[static_cast<std::size_t>(best)]);
  refiners.resize(1);
}

// Of refined maps the one that the judge likes best; without one the first, of least energy.
ShellMap choose(const Refiners& refiners, const LaidOutShell& a, const LaidOutShell& b,
                const ShellMapSettings& settings) {
  const Locator onB(b.surface.triangles, b.layout);
  const bool judge = settings.judge && refiners.size() > 1;
  ShellMap best;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& refiner : refiners) {
    ShellMap map;
    map.energy = refiner->energy();
    map.origin = refiner->origin();
    map.image = refiner->takeImage();
    if (!judge) return map;
    const double score =
        settings.judge->score(imagesOf(settings.judge->at, a.surface, map.image, b, onB));
    if (!best.image.place.empty() && !(score < least)) continue;
    least = score;
    best = std::move(map);
  }
  return best;
}

ShellMap bestOf(Refiners refiners, const LaidOutShell& a, const LaidOutShell& b,
                const ShellMapSettings& settings) {
  const std::size_t vertices = a.surface.vertices.size();
  const bool judgeEarly = settings.judge && a.layout.space == ModelSpace::sphere;
  const std::size_t kept = judgeEarly ? 1 : static_cast<std::size_t>(settings.candidates);
  if (refiners.size() > kept) {
    refineAll(refiners, std::min(kMiddle, vertices), settings.progress);
    if (judgeEarly && refiners.size() > 1) keepBest(refiners, a, b, settings);
    if (refiners.size() > kept) refiners.resize(kept);
  }
  if (refiners.size() > 1 && outOfTime(settings.progress)) refiners.resize(1);
  refineAll(refiners, vertices, settings.progress);
  if (refiners.empty())
    throw DataError(a.surface.name +
                    ": no map without flips was found; remove slivers from the mesh, or give "
                    "landmarks");
  return choose(refiners, a, b, settings);
}

RefineSettings refining(const ClosedSurface& surface, const ShellMapSettings& settings) {
  RefineSettings out;
  out.relax = settings.refine;
  out.progress = settings.progress;
  if (settings.landmarks.empty()) return out;
  out.fixed.assign(surface.vertices.size(), 0);
  for (const Anchor& a : settings.landmarks) out.fixed[a.vertex] = 1;
  return out;
}

// B with fewer vertices, each where B's layout has it.
struct CoarseTarget {
  explicit CoarseTarget(const LaidOutShell& b, Progress* progress)
      : shape(coarsened(b, progress)), metric(shape.surface, layoutOf(b, shape)) {}

  static CoarseSurface coarsened(const LaidOutShell& b, Progress* progress) {
    ProgressiveMesh mesh(b.surface.vertices.size(), b.surface.triangles);
    DecimateSettings settings;
    settings.vertices = kCoarseTarget;
    settings.layout = &b.layout;
    settings.keep.assign(b.surface.vertices.size(), 0);
    for (const int v : b.tips.vertices) settings.keep[v] = 1;
    settings.progress = progress;
    decimate(mesh, b.surface.vertices, settings);
    return coarseSurface(b.surface, mesh);
  }

  static Layout layoutOf(const LaidOutShell& b, const CoarseSurface& shape) {
    Layout out;
    for (const int v : shape.vertex) out.place.push_back(b.layout.place[v]);
    return out;
  }

  const CoarseSurface shape;
  const TargetMetric metric;
};

ShellMap mapSphere(const LaidOutShell& a, const LaidOutShell& b, const ShellMapSettings& settings) {
  SphereCandidateSettings search;
  search.landmarks = settings.landmarks;
  search.aligned = settings.aligned;
  search.thorough = settings.refine;
  search.kept = settings.judge    ? kJudged
                : settings.refine ? std::max(kTried, static_cast<std::size_t>(settings.candidates))
                                  : 1;
  search.seed = settings.seed;
  search.progress = settings.progress;
  const CoarseTarget target(b, settings.progress);
  Candidates candidates = sphereCandidates(a.surface, a.layout, a.tips, target.shape.surface,
                                           target.metric, b.tips, search);
  std::vector<ConsideredMap> considered;
  if (settings.judge) {
    considered = judged(candidates, a, b, settings);
    const std::size_t best = settings.refine ? static_cast<std::size_t>(settings.candidates) : 1;
    if (candidates.maps.size() > best) candidates.maps.resize(best);
  }
  const RefineSettings how = refining(a.surface, settings);
  Refiners refiners;
  for (const CoarseMap& m : candidates.maps)
    refiners.push_back(std::make_unique<MapRefiner>(a.surface, candidates.mesh, candidates.coarse,
                                                    m, b.metric, how));
  ShellMap out = bestOf(std::move(refiners), a, b, settings);
  out.considered = std::move(considered);
  return out;
}

// Each candidate has frames of its own, so each is coarsened by itself.
std::unique_ptr<MapRefiner> startTorus(const LaidOutShell& a, const LaidOutShell& b,
                                       const TorusCandidate& candidate,
                                       const ShellMapSettings& settings) {
  ProgressiveMesh mesh(a.surface.vertices.size(), a.surface.triangles, candidate.image.shift);
  DecimateSettings coarsening;
  coarsening.vertices = std::max(kCoarse, 8 * settings.landmarks.size());
  coarsening.layout = &candidate.image;
  coarsening.keep.assign(a.surface.vertices.size(), 0);
  for (const Anchor& l : settings.landmarks) coarsening.keep[l.vertex] = 1;
  coarsening.progress = settings.progress;
  decimate(mesh, a.surface.vertices, coarsening);
  const CoarseSurface coarse = coarseSurface(a.surface, mesh);
  Layout start = candidate.image;
  start.place.clear();
  for (const int v : coarse.vertex) start.place.push_back(candidate.image.place[v]);
  start.shift = coarse.shift;
  CoarseMapSettings relax;
  for (const Anchor& l : settings.landmarks)
    relax.fixed.push_back({coarse.index[l.vertex], l.target});
  relax.progress = settings.progress;
  std::optional<CoarseMap> map = relaxCoarse(coarse, start, b.metric, relax);
  if (!map) return nullptr;
  map->origin = fmt::format("twist {}{}", candidate.twist, candidate.reversed ? ", reversed" : "");
  return std::make_unique<MapRefiner>(a.surface, mesh, coarse, *map, b.metric,
                                      refining(a.surface, settings));
}

ShellMap mapTorus(const LaidOutShell& a, const LaidOutShell& b, const ShellMapSettings& settings) {
  TorusSearch search;
  search.count = std::max(kTried, static_cast<std::size_t>(settings.candidates));
  search.aligned = settings.aligned;
  for (const Anchor& l : settings.landmarks)
    search.landmarks.push_back({a.layout.place[l.vertex], l.target});
  search.seed = settings.seed;
  search.progress = settings.progress;
  const std::vector<TorusCandidate> candidates =
      torusCandidates(a.surface, a.layout, b.surface, b.layout, search);
  Refiners all(candidates.size()), refiners;
  parallelBlocks(
      candidates.size(), 1,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          all[i] = startTorus(a, b, candidates[i], settings);
      },
      settings.progress, "trying first maps");
  for (std::unique_ptr<MapRefiner>& r : all)
    if (r) refiners.push_back(std::move(r));
  if (refiners.empty() && !settings.landmarks.empty())
    throw DataError(
        "landmarks: no map without flips was found that meets them all; check them, or leave some "
        "out");
  return bestOf(std::move(refiners), a, b, settings);
}

}  // namespace

LaidOutShell::LaidOutShell(const ClosedSurface& shell, Progress* progress)
    : LaidOutShell(shell, layOut(shell, progress), progress) {}

LaidOutShell::LaidOutShell(const ClosedSurface& shell, Layout laidOut, Progress* progress)
    : surface(shell),
      layout(std::move(laidOut)),
      metric(surface, layout),
      tips(layout.space == ModelSpace::sphere ? limbTips(surface, layout, 800, progress)
                                              : LimbTips{}) {}

ShellMap mapShell(const LaidOutShell& a, const LaidOutShell& b, const ShellMapSettings& settings) {
  return a.layout.space == ModelSpace::sphere ? mapSphere(a, b, settings)
                                              : mapTorus(a, b, settings);
}

}  // namespace innermap
