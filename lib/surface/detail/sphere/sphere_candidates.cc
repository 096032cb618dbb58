#include "surface/detail/sphere/sphere_candidates.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <functional>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "surface/detail/refining/decimate.h"
#include "surface/detail/refining/map_samples.h"
#include "surface/detail/sphere/rotation_search.h"
#include "surface/detail/sphere/sphere_starts.h"

namespace innermap {
namespace {

constexpr std::size_t kSamples = 400;  // that rotations are judged by
constexpr std::size_t kRotations = 6;
constexpr double kLandmarkWeight = 40;  // of the mean squared distance, radians, in the energy
constexpr std::size_t kPulled = 24;     // maps that are then pulled onto the landmarks

// Vertices of the meshes that starts are tried on: all on the first, the best of them on the
// second.
constexpr std::size_t kTiny = 60, kCoarse = 150, kSecondRound = 14;

void landmarkPlaces(const std::vector<Anchor>& landmarks, const Layout& la, Points& from,
                    Points& to) {
  for (const Anchor& l : landmarks) {
    from.push_back(la.place[l.vertex]);
    to.push_back(l.target);
  }
}

// Any landmarks can be met by some map without flips; those of a mirror image only by one that
// nobody wants.
void requireOrientation(const Points& from, const Points& to) {
  if (from.size() < 4) return;
  Points mirrored;
  for (const Vec3& p : from) mirrored.push_back(-p);
  const double proper = rotationMisfit(bestRotation(from, to), from, to),
               improper = rotationMisfit(bestRotation(mirrored, to), mirrored, to);
  if (proper > 0.6 && improper < 0.5 * proper)
    throw DataError(
        "landmarks: they contradict the orientation: a mirror image of the source would fit them; "
        "exchange left and right of one side");
}

Layout rotatedCoarse(const CoarseSurface& coarse, const Layout& la, const Mat3& rotation) {
  Layout out;
  for (const int v : coarse.vertex) {
    const Vec3 p = rotation * la.place[v];
    out.place.push_back(p / norm(p));
  }
  return out;
}

std::vector<Anchor> coarseAnchors(const std::vector<Anchor>& fine, const CoarseSurface& coarse) {
  std::vector<Anchor> out;
  for (const Anchor& a : fine) out.push_back({coarse.index[a.vertex], a.target});
  return out;
}

// How far normals disagree, of a coarse map: what `aligned` adds to the energy.
double normalCost(const CoarseSurface& coarse, const CoarseMap& map, const TargetMetric& target,
                  const Points& normals) {
  const std::vector<MapSample> samples = sampleSource(coarse.surface, map.image, kSamples, 1);
  double sum = 0;
  for (const MapSample& s : samples)
    sum += 1 - dot(s.normal, normals[target.locator().find(s.x).triangle]);
  return 16 * sum / static_cast<double>(samples.size());
}

void keepBest(std::vector<CoarseMap>& maps, std::size_t kept) {
  std::stable_sort(maps.begin(), maps.end(),
                   [](const CoarseMap& x, const CoarseMap& y) { return x.energy < y.energy; });
  // Starts often end in the same map.
  std::vector<CoarseMap> out;
  for (CoarseMap& m : maps) {
    if (out.size() == kept) break;
    const bool known = std::any_of(out.begin(), out.end(), [&](const CoarseMap& o) {
      double sum = 0;
      for (std::size_t v = 0; v < m.image.place.size(); ++v)
        sum += norm(m.image.place[v] - o.image.place[v]);
      return sum < 0.1 * static_cast<double>(m.image.place.size());
    });
    if (!known) out.push_back(std::move(m));
  }
  maps = std::move(out);
}

// Maps on one coarse mesh; empty where the way was blocked.
class Trial {
 public:
  Trial(const Layout& la, const TargetMetric& target, const SphereCandidateSettings& settings,
        const Points& normals)
      : la_(la), target_(target), settings_(settings), normals_(normals) {}

  using Maps = std::vector<std::optional<CoarseMap>>;

  // From each start. Landmarks are not met yet, but weigh: a good map that comes near them meets
  // them with less distortion than one that was pulled there from afar.
  Maps run(const std::vector<MapStart>& starts, const CoarseSurface& coarse,
           const CoarseMapSettings& how) {
    Maps found(starts.size());
    std::atomic<bool> some{false};
    parallel(starts.size(), [&](std::size_t i) {
      if (some && outOfTime()) return;
      CoarseMapSettings drawing = how;
      drawing.drawn = coarseAnchors(starts[i].drawn, coarse);
      found[i] = relax(rotatedCoarse(coarse, la_, starts[i].rotation), coarse, drawing);
      if (!found[i]) return;
      some = true;
      found[i]->origin = starts[i].origin;
      found[i]->energy += landmarkCost(*found[i], coarse);
    });
    return found;
  }

  // Maps again, with the limb tips drawn together that have come near one another, and landmarks
  // met.
  Maps rerun(const std::vector<CoarseMap>& maps, const CoarseSurface& coarse, const LimbTips& tipsA,
             const LimbTips& tipsB) {
    Maps found(2 * maps.size());
    std::atomic<bool> some{settings_.landmarks.empty()};
    parallel(found.size(), [&](std::size_t i) {
      if (some && outOfTime()) return;
      const CoarseMap& from = maps[i / 2];
      CoarseMapSettings how;
      how.fixed = coarseAnchors(settings_.landmarks, coarse);
      std::string origin = from.origin;
      if (i % 2 == 1) {
        Points places;
        for (const int v : tipsA.vertices) places.push_back(from.image.place[coarse.index[v]]);
        const TipPairs pairs = nearestTips(places, tipsB);
        if (pairs.empty()) return;
        how.drawn = coarseAnchors(anchorsOf(pairs, tipsA, tipsB), coarse);
        origin += fmt::format(", then {} limbs", pairs.size());
      } else if (how.fixed.empty()) {
        return;
      }
      found[i] = relax(from.image, coarse, how);
      if (!found[i]) return;
      some = true;
      found[i]->origin = origin;
    });
    return found;
  }

  int blocked() const { return blocked_; }  // a landmark that was not reached, or -1

 private:
  void parallel(std::size_t count, const std::function<void(std::size_t)>& body) {
    parallelBlocks(
        count, 1,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) body(i);
        },
        "trying first maps");
  }

  std::optional<CoarseMap> relax(const Layout& start, const CoarseSurface& coarse,
                                 CoarseMapSettings how) {
    // A tip that is a landmark already goes where that says.
    const auto isFixed = [&](const Anchor& d) {
      return std::any_of(how.fixed.begin(), how.fixed.end(),
                         [&](const Anchor& f) { return f.vertex == d.vertex; });
    };
    how.drawn.erase(std::remove_if(how.drawn.begin(), how.drawn.end(), isFixed), how.drawn.end());
    int blocked = -1;
    std::optional<CoarseMap> out = relaxCoarse(coarse, start, target_, how, &blocked);
    if (out && settings_.aligned) out->energy += normalCost(coarse, *out, target_, normals_);
    if (blocked >= 0 && blocked < static_cast<int>(how.fixed.size())) blocked_ = blocked;
    return out;
  }

  double landmarkCost(const CoarseMap& map, const CoarseSurface& coarse) const {
    double sum = 0;
    for (const Anchor& l : settings_.landmarks)
      sum += squaredNorm(map.image.place[coarse.index[l.vertex]] - l.target);
    const std::size_t count = settings_.landmarks.size();
    return count > 0 ? kLandmarkWeight * sum / static_cast<double>(count) : 0;
  }

  const Layout& la_;
  const TargetMetric& target_;
  const SphereCandidateSettings& settings_;
  const Points& normals_;
  std::atomic<int> blocked_{-1};
};

CoarseSurface coarsened(const ClosedSurface& a, const Layout& la, ProgressiveMesh& mesh,
                        const std::vector<char>& keep, std::size_t vertices) {
  DecimateSettings settings;
  settings.vertices = vertices;
  settings.layout = &la;
  settings.keep = keep;
  decimate(mesh, a.vertices, settings);
  return coarseSurface(a, mesh);
}

std::vector<MapStart> bestStarts(const std::vector<MapStart>& starts,
                                 const std::vector<std::optional<CoarseMap>>& maps) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < starts.size(); ++i)
    if (maps[i]) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t x, std::size_t y) { return maps[x]->energy < maps[y]->energy; });
  std::vector<MapStart> out;
  std::size_t kept = 0;
  for (const std::size_t i : order)
    if (starts[i].promising || kept++ < kSecondRound) out.push_back(starts[i]);
  return out;
}

std::vector<MapStart> startsFor(const ClosedSurface& a, const Layout& la, const LimbTips& tipsA,
                                const TargetMetric& target, const LimbTips& tipsB,
                                const Points& normals, const SphereCandidateSettings& settings) {
  RotationSearchSettings search;
  search.kept = kRotations;
  if (settings.aligned) search.targetNormals = &normals;
  landmarkPlaces(settings.landmarks, la, search.from, search.to);
  requireOrientation(search.from, search.to);
  std::vector<MapStart> starts =
      sphereStarts(searchRotations(sampleSource(a, la, kSamples, settings.seed), target, search),
                   tipsA, tipsB, search.from, search.to);
  if (!settings.thorough)
    starts.erase(std::remove_if(starts.begin(), starts.end(),
                                [](const MapStart& s) { return !s.promising; }),
                 starts.end());
  return starts;
}

}  // namespace

Candidates sphereCandidates(const ClosedSurface& a, const Layout& la, const LimbTips& tipsA,
                            const ClosedSurface& b, const TargetMetric& target,
                            const LimbTips& tipsB, const SphereCandidateSettings& settings) {
  std::vector<char> keep(a.vertices.size(), 0);
  for (const int v : tipsA.vertices) keep[v] = 1;
  for (const Anchor& l : settings.landmarks) keep[l.vertex] = 1;
  Candidates out{ProgressiveMesh(a.vertices.size(), a.triangles), {}, {}};
  out.coarse = coarsened(a, la, out.mesh, keep, kCoarse + 12 * settings.landmarks.size());
  ProgressiveMesh tinyMesh = out.mesh;
  const CoarseSurface tiny =
      coarsened(a, la, tinyMesh, keep, kTiny + 4 * settings.landmarks.size());

  const Points normals = settings.aligned ? unitNormals(b) : Points{};
  std::vector<MapStart> starts = startsFor(a, la, tipsA, target, tipsB, normals, settings);
  Trial trial(la, target, settings, normals);
  if (starts.size() > kSecondRound) {
    CoarseMapSettings quick;
    quick.samples = 450;
    quick.sweeps = 3;
    quick.near = 0.1;
    quick.patience = 5;
    std::vector<MapStart> best = bestStarts(starts, trial.run(starts, tiny, quick));
    if (!best.empty()) starts = std::move(best);
  }
  const auto take = [&](Trial::Maps maps) {
    for (std::optional<CoarseMap>& m : maps)
      if (m) out.maps.push_back(std::move(*m));
  };
  take(trial.run(starts, out.coarse, {}));
  std::vector<CoarseMap> first = out.maps;
  if (!settings.landmarks.empty()) {
    keepBest(first, kPulled);
    out.maps.clear();
  }
  take(trial.rerun(first, out.coarse, tipsA, tipsB));
  if (out.maps.empty() && !settings.landmarks.empty())
    throw DataError(fmt::format(
        "landmarks: no map without flips was found that meets {}; check them, or leave some out",
        trial.blocked() < 0 ? "them all"
                            : fmt::format("number {} with the others", 1 + trial.blocked())));
  keepBest(out.maps, settings.kept);
  return out;
}

}  // namespace innermap
