#include "surface/detail/refining/shell_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "surface/detail/refining/decimate.h"
#include "surface/detail/refining/judged_maps.h"
#include "surface/detail/refining/map_refiner.h"
#include "surface/detail/refining/ways_round.h"
#include "surface/detail/sphere/sphere_candidates.h"
#include "surface/detail/torus/torus_candidates.h"

namespace innermap {
namespace {

constexpr std::size_t kTried = 10;   // candidates that are refined to
constexpr std::size_t kJudged = 40;  // first maps that a judge hears
constexpr std::size_t kCoarse = 150;
// Of B, while first maps are looked for: these have triangles far larger, and finding places among
// B's own is most of the work.
constexpr std::size_t kCoarseTarget = 2000;

using Refiners = std::vector<std::unique_ptr<MapRefiner>>;

// Refines all to so many vertices; those that get stuck are left out, the best come first.
void refineAll(Refiners& refiners, std::size_t vertices) {
  std::vector<double> energy(refiners.size());
  std::vector<char> good(refiners.size(), 0);
  parallelBlocks(refiners.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      good[i] = refiners[i]->refineTo(vertices);
      energy[i] = refiners[i]->energy();
    }
  });
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < refiners.size(); ++i)
    if (good[i]) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t x, std::size_t y) { return energy[x] < energy[y]; });
  Refiners out;
  for (const std::size_t i : order) out.push_back(std::move(refiners[i]));
  refiners = std::move(out);
}

// Of refined maps the one of the way that is wanted, by the judge; without one the first, of least
// energy.
ShellMap choose(const Refiners& refiners, const LaidOutShell& a, const LaidOutShell& b,
                const ShellMapSettings& settings) {
  std::vector<ShellMap> maps;
  for (const auto& refiner : refiners) {
    maps.emplace_back();
    maps.back().energy = refiner->energy();
    maps.back().origin = refiner->origin();
    maps.back().image = refiner->takeImage();
    if (!settings.judge) return std::move(maps.front());
  }
  const Locator onB(b.surface.triangles, b.layout);
  const Points points = interpolate(a.surface.vertices, a.surface.triangles, settings.judge->at);
  std::vector<JudgedMap> judged;
  for (const ShellMap& map : maps)
    judged.push_back(judgedMap(*settings.judge, points,
                               imagesOf(settings.judge->at, a.surface, map.image, b, onB)));
  const std::vector<std::size_t> order = byPreference(judged);
  std::vector<JudgedMap> sorted;
  for (const std::size_t i : order) sorted.push_back(judged[i]);
  const std::vector<std::size_t> ways = waysOf(sorted);
  const std::size_t wanted = wantedWay(sorted, ways, settings.wanted, a.surface.name);
  const auto found = std::find(ways.begin(), ways.end(), wanted) - ways.begin();
  ShellMap& out = maps[order[static_cast<std::size_t>(found)]];
  out.way = static_cast<int>(wanted) + 1;
  return std::move(out);
}

ShellMap bestOf(Refiners refiners, const LaidOutShell& a, const LaidOutShell& b,
                const ShellMapSettings& settings) {
  const std::size_t vertices = a.surface.vertices.size();
  const auto kept = static_cast<std::size_t>(settings.candidates);
  if (refiners.size() > kept) {
    refineAll(refiners, std::min(kMiddle, vertices));
    if (refiners.size() > kept) refiners.resize(kept);
  }
  if (refiners.size() > 1 && outOfTime()) refiners.resize(1);
  refineAll(refiners, vertices);
  if (refiners.empty()) throw noMapWithoutFlips(a.surface);
  return choose(refiners, a, b, settings);
}

RefineSettings refining(const ClosedSurface& surface, const ShellMapSettings& settings) {
  RefineSettings out;
  out.relax = settings.refine;
  if (settings.landmarks.empty()) return out;
  out.fixed.assign(surface.vertices.size(), 0);
  for (const Anchor& a : settings.landmarks) out.fixed[a.vertex] = 1;
  return out;
}

// B with fewer vertices, each where B's layout has it.
struct CoarseTarget {
  explicit CoarseTarget(const LaidOutShell& b)
      : shape(coarsened(b)), metric(shape.surface, layoutOf(b, shape)) {}

  static CoarseSurface coarsened(const LaidOutShell& b) {
    ProgressiveMesh mesh(b.surface.vertices.size(), b.surface.triangles);
    DecimateSettings settings;
    settings.vertices = kCoarseTarget;
    settings.layout = &b.layout;
    settings.keep.assign(b.surface.vertices.size(), 0);
    for (const int v : b.tips.vertices) settings.keep[v] = 1;
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

Candidates firstMaps(const LaidOutShell& a, const LaidOutShell& b,
                     const ShellMapSettings& settings) {
  SphereCandidateSettings search;
  search.landmarks = settings.landmarks;
  search.aligned = settings.aligned;
  search.thorough = settings.refine;
  search.kept = settings.judge    ? kJudged
                : settings.refine ? std::max(kTried, static_cast<std::size_t>(settings.candidates))
                                  : 1;
  search.seed = settings.seed;
  const CoarseTarget target(b);
  return sphereCandidates(a.surface, a.layout, a.tips, target.shape.surface, target.metric, b.tips,
                          search);
}

ShellMap mapSphere(const LaidOutShell& a, const LaidOutShell& b, const ShellMapSettings& settings) {
  const Candidates candidates = firstMaps(a, b, settings);
  const RefineSettings how = refining(a.surface, settings);
  if (settings.judge) return judgedMapOf(a, b, candidates, how, settings);
  Refiners refiners;
  for (const CoarseMap& m : candidates.maps)
    refiners.push_back(std::make_unique<MapRefiner>(a.surface, candidates.mesh, candidates.coarse,
                                                    m, b.metric, how));
  return bestOf(std::move(refiners), a, b, settings);
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
  decimate(mesh, a.surface.vertices, coarsening);
  const CoarseSurface coarse = coarseSurface(a.surface, mesh);
  Layout start = candidate.image;
  start.place.clear();
  for (const int v : coarse.vertex) start.place.push_back(candidate.image.place[v]);
  start.shift = coarse.shift;
  CoarseMapSettings relax;
  for (const Anchor& l : settings.landmarks)
    relax.fixed.push_back({coarse.index[l.vertex], l.target});
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
  const std::vector<TorusCandidate> candidates =
      torusCandidates(a.surface, a.layout, b.surface, b.layout, search);
  Refiners all(candidates.size()), refiners;
  parallelBlocks(
      candidates.size(), 1,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          all[i] = startTorus(a, b, candidates[i], settings);
      },
      "trying first maps");
  for (std::unique_ptr<MapRefiner>& r : all)
    if (r) refiners.push_back(std::move(r));
  if (refiners.empty() && !settings.landmarks.empty())
    throw DataError(
        "landmarks: no map without flips was found that meets them all; check them, or leave some "
        "out");
  return bestOf(std::move(refiners), a, b, settings);
}

}  // namespace

ShellMap mapShell(const LaidOutShell& a, const LaidOutShell& b, const ShellMapSettings& settings) {
  if (!settings.judge) requireOnlyWay(settings.wanted, "without a judge of the inside they are");
  return a.layout.space == ModelSpace::sphere ? mapSphere(a, b, settings)
                                              : mapTorus(a, b, settings);
}

}  // namespace innermap
