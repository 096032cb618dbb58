#include "innermap/surface/sphere_candidates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "innermap/core/error.h"
#include "innermap/core/parallel.h"
#include "innermap/surface/decimate.h"
#include "innermap/surface/map_samples.h"
#include "innermap/surface/rotation_search.h"

namespace innermap {
namespace {

constexpr std::size_t kSamples = 400;  // that rotations are judged by
constexpr std::size_t kRotations = 6, kMatchings = 300;

// Vertices of the meshes that starts are tried on: all on the first, the best of them on the
// second.
constexpr std::size_t kTiny = 60, kCoarse = 150, kSecondRound = 20;

struct Start {
  Mat3 rotation;
  std::vector<Anchor> drawn;  // fine vertices
  std::string origin;
};

// Tips that are each other's nearest after the rotation, and not too far.
TipPairs nearestTips(const LimbTips& a, const LimbTips& b, const Mat3& rotation) {
  const auto nearest = [](const Vec3& p, const Points& to) {
    int best = 0;
    for (int i = 1; i < static_cast<int>(to.size()); ++i)
      if (squaredNorm(to[i] - p) < squaredNorm(to[best] - p)) best = i;
    return best;
  };
  Points turned;
  for (const Vec3& p : a.place) turned.push_back(rotation * p);
  TipPairs out;
  for (int i = 0; i < static_cast<int>(turned.size()); ++i) {
    const int j = nearest(turned[i], b.place);
    if (nearest(b.place[j], turned) == i && norm(turned[i] - b.place[j]) < 0.9)
      out.push_back({i, j});
  }
  return out;
}

std::vector<Anchor> anchorsOf(const TipPairs& pairs, const LimbTips& a, const LimbTips& b) {
  std::vector<Anchor> out;
  for (const auto& [i, j] : pairs) out.push_back({a.vertices[i], b.place[j]});
  return out;
}

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

std::vector<Start> startsOf(const std::vector<RotationCandidate>& rotations, const LimbTips& tipsA,
                            const LimbTips& tipsB, bool useTips) {
  std::vector<Start> out;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    out.push_back({rotations[i].rotation, {}, fmt::format("rotation {}", i + 1)});
    if (!useTips) continue;
    const TipPairs pairs = nearestTips(tipsA, tipsB, rotations[i].rotation);
    if (pairs.size() >= 2)
      out.push_back({rotations[i].rotation, anchorsOf(pairs, tipsA, tipsB),
                     fmt::format("rotation {} with {} limbs drawn together", i + 1, pairs.size())});
  }
  if (!useTips) return out;
  for (const TipPairs& pairs : matchTips(tipsA, tipsB, kMatchings)) {
    Points from, to;
    for (const auto& [i, j] : pairs) {
      from.push_back(tipsA.place[i]);
      to.push_back(tipsB.place[j]);
    }
    out.push_back({bestRotation(from, to), anchorsOf(pairs, tipsA, tipsB),
                   fmt::format("{} matched limbs", pairs.size())});
  }
  return out;
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

// Maps on one coarse mesh from each start; empty where the way was blocked.
class Trial {
 public:
  Trial(const Layout& la, const TargetMetric& target, const SphereCandidateSettings& settings,
        const Points& normals)
      : la_(la), target_(target), settings_(settings), normals_(normals) {}

  std::vector<std::optional<CoarseMap>> run(const std::vector<Start>& starts,
                                            const CoarseSurface& coarse,
                                            const CoarseMapSettings& how) {
    std::vector<std::optional<CoarseMap>> found(starts.size());
    std::vector<int> blocked(starts.size(), -1);
    parallelBlocks(
        starts.size(), 1,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            CoarseMapSettings relax = how;
            relax.fixed = coarseAnchors(settings_.landmarks, coarse);
            relax.drawn = coarseAnchors(starts[i].drawn, coarse);
            relax.progress = settings_.progress;
            found[i] = relaxCoarse(coarse, rotatedCoarse(coarse, la_, starts[i].rotation), target_,
                                   relax, &blocked[i]);
            if (!found[i]) continue;
            found[i]->origin = starts[i].origin;
            if (settings_.aligned)
              found[i]->energy += normalCost(coarse, *found[i], target_, normals_);
          }
        },
        settings_.progress, "trying first maps");
    for (const int b : blocked) blocked_ = std::max(blocked_, b);
    return found;
  }

  int blocked() const { return blocked_; }  // a landmark that was not reached, or -1

 private:
  const Layout& la_;
  const TargetMetric& target_;
  const SphereCandidateSettings& settings_;
  const Points& normals_;
  int blocked_ = -1;
};

CoarseSurface coarsened(const ClosedSurface& a, const Layout& la, ProgressiveMesh& mesh,
                        const std::vector<char>& keep, std::size_t vertices, Progress* progress) {
  DecimateSettings settings;
  settings.vertices = vertices;
  settings.layout = &la;
  settings.keep = keep;
  settings.progress = progress;
  decimate(mesh, a.vertices, settings);
  return coarseSurface(a, mesh);
}

std::vector<Start> bestStarts(const std::vector<Start>& starts,
                              const std::vector<std::optional<CoarseMap>>& maps) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < starts.size(); ++i)
    if (maps[i]) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t x, std::size_t y) { return maps[x]->energy < maps[y]->energy; });
  std::vector<Start> out;
  for (const std::size_t i : order)
    if (out.size() < kSecondRound) out.push_back(starts[i]);
  return out;
}

}  // namespace

Candidates sphereCandidates(const ClosedSurface& a, const Layout& la, const LimbTips& tipsA,
                            const ClosedSurface& b, const TargetMetric& target,
                            const LimbTips& tipsB, const SphereCandidateSettings& settings) {
  std::vector<char> keep(a.vertices.size(), 0);
  for (const int v : tipsA.vertices) keep[v] = 1;
  for (const Anchor& l : settings.landmarks) keep[l.vertex] = 1;
  Candidates out{ProgressiveMesh(a.vertices.size(), a.triangles), {}, {}};
  out.coarse = coarsened(a, la, out.mesh, keep, std::max(kCoarse, 8 * settings.landmarks.size()),
                         settings.progress);
  ProgressiveMesh tinyMesh = out.mesh;
  const CoarseSurface tiny = coarsened(
      a, la, tinyMesh, keep, std::max(kTiny, 4 * settings.landmarks.size()), settings.progress);

  const Points normals = settings.aligned ? unitNormals(b) : Points{};
  RotationSearchSettings search;
  search.kept = kRotations;
  if (settings.aligned) search.targetNormals = &normals;
  landmarkPlaces(settings.landmarks, la, search.from, search.to);
  requireOrientation(search.from, search.to);
  search.progress = settings.progress;
  std::vector<Start> starts =
      startsOf(searchRotations(sampleSource(a, la, kSamples, settings.seed), target, search), tipsA,
               tipsB, settings.landmarks.size() < 3);
  Trial trial(la, target, settings, normals);
  if (starts.size() > kSecondRound) {
    CoarseMapSettings quick;
    quick.samples = 450;
    quick.sweeps = 3;
    quick.near = 0.1;
    quick.patience = 5;
    starts = bestStarts(starts, trial.run(starts, tiny, quick));
  }
  for (std::optional<CoarseMap>& m : trial.run(starts, out.coarse, {}))
    if (m) out.maps.push_back(std::move(*m));
  if (out.maps.empty() && !settings.landmarks.empty())
    throw DataError(
        fmt::format("landmarks: no map without flips was found that meets number {}; it "
                    "contradicts the others: check it, or leave it out",
                    1 + trial.blocked()));
  keepBest(out.maps, settings.kept);
  return out;
}

}  // namespace innermap
