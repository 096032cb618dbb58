#include "surface/detail/refining/judged_maps.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "innermap/core/run.h"
#include "surface/detail/refining/layout_map.h"
#include "surface/detail/refining/ways_round.h"

namespace innermap {
namespace {

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

class JudgedMaps {
 public:
  JudgedMaps(const LaidOutShell& a, const LaidOutShell& b, const Candidates& candidates,
             const RefineSettings& refining, const ShellMapSettings& settings)
      : a_(a),
        b_(b),
        candidates_(candidates),
        refining_(refining),
        settings_(settings),
        onB_(b.surface.triangles, b.layout),
        points_(interpolate(a.surface.vertices, a.surface.triangles, settings.judge->at)) {
    judgeFirst();
    refineSome();
  }

  // Of the way that is wanted.
  ShellMap take() {
    const std::vector<JudgedMap> judged = judgedOf(maps_.size());
    const std::vector<std::size_t> ways = waysOf(judged);
    const std::size_t wanted = wantedWay(judged, ways, settings_.wanted, a_.surface.name);
    ShellMap out;
    for (std::size_t m = 0; m < maps_.size() && out.image.place.empty(); ++m)
      if (ways[m] == wanted && refine(m, a_.surface.vertices.size())) finish(m, ways, out);
    if (out.image.place.empty()) throw noMapWithoutFlips(a_.surface);
    return out;
  }

 private:
  struct JudgedCandidate {
    CoarseMap first;
    JudgedMap judged;  // as it is now
    double firstScore = 0;
    std::unique_ptr<MapRefiner> refiner;  // where it has been refined
  };

  // Of the first ones.
  std::vector<JudgedMap> judgedOf(std::size_t count) const {
    std::vector<JudgedMap> out;
    for (std::size_t m = 0; m < count; ++m) out.push_back(maps_[m].judged);
    return out;
  }

  void judge(JudgedCandidate& map, const CoarseSurface& shape, const Layout& image) const {
    const std::vector<SurfacePoint> at = onCoarse(settings_.judge->at, a_, shape);
    map.judged = judgedMap(*settings_.judge, points_, imagesOf(at, shape.surface, image, b_, onB_));
  }

  void judgeFirst() {
    for (const CoarseMap& m : candidates_.maps) maps_.push_back({m, {}, 0, nullptr});
    parallelBlocks(
        maps_.size(), 1,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            judge(maps_[i], candidates_.coarse, maps_[i].first.image);
            maps_[i].firstScore = maps_[i].judged.score;
          }
        },
        "judging first maps");
    std::stable_sort(maps_.begin(), maps_.end(),
                     [](const auto& x, const auto& y) { return x.firstScore < y.firstScore; });
  }

  // The best, with the best of the next way where that is as good; the preferred one comes first.
  void refineSome() {
    std::size_t count = std::min(maps_.size(), static_cast<std::size_t>(settings_.candidates));
    const auto other = std::find_if(maps_.begin(), maps_.end(), [&](const JudgedCandidate& m) {
      return !sameWay(m.judged, maps_.front().judged);
    });
    if (other - maps_.begin() >= static_cast<std::ptrdiff_t>(count) && other != maps_.end() &&
        asGood(other->judged, maps_.front().judged))
      std::rotate(maps_.begin() + static_cast<std::ptrdiff_t>(count++), other, other + 1);
    if (!settings_.refine || outOfTime()) count = std::min<std::size_t>(count, 1);
    std::vector<char> good(count, 1);
    if (count > 1)
      parallelBlocks(count, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          if ((good[i] = refine(i, std::min(kMiddle, a_.surface.vertices.size())))) {
            const RefinedSoFar map = maps_[i].refiner->soFar();
            judge(maps_[i], map.surface, map.image);
          }
      });
    for (std::size_t i = count; i-- > 0;)  // those that got stuck
      if (!good[i]) {
        maps_.erase(maps_.begin() + static_cast<std::ptrdiff_t>(i));
        --count;
      }
    sortFirst(settings_.refine ? count : maps_.size());
  }

  void sortFirst(std::size_t count) {
    std::vector<JudgedCandidate> sorted;
    for (const std::size_t i : byPreference(judgedOf(count))) sorted.push_back(std::move(maps_[i]));
    std::move(sorted.begin(), sorted.end(), maps_.begin());
  }

  // False where it gets stuck.
  bool refine(std::size_t m, std::size_t vertices) {
    JudgedCandidate& map = maps_[m];
    if (!map.refiner)
      map.refiner = std::make_unique<MapRefiner>(a_.surface, candidates_.mesh, candidates_.coarse,
                                                 map.first, b_.metric, refining_);
    return map.refiner->refineTo(vertices);
  }

  // The map m, all of whose vertices are there, and what the others are.
  void finish(std::size_t m, const std::vector<std::size_t>& ways, ShellMap& out) {
    for (std::size_t i = 0; i < maps_.size(); ++i)
      out.considered.push_back({maps_[i].first.origin, maps_[i].first.energy, maps_[i].firstScore,
                                degreesOf(maps_[i].judged.turn), static_cast<int>(ways[i]) + 1});
    std::stable_sort(out.considered.begin(), out.considered.end(),
                     [](const auto& x, const auto& y) { return x.score < y.score; });
    out.way = static_cast<int>(ways[m]) + 1;
    out.energy = maps_[m].refiner->energy();
    out.origin = maps_[m].refiner->origin();
    out.image = maps_[m].refiner->takeImage();
    for (std::size_t i = 0; i < maps_.size(); ++i) {
      if (ways[i] == ways[m] || !asGood(maps_[i].judged, maps_[m].judged)) continue;
      out.other = otherWay(i, ways[i]);
      out.other->score = {maps_[m].judged.score, maps_[i].judged.score};
      out.other->turn = {degreesOf(maps_[m].judged.turn), degreesOf(maps_[i].judged.turn)};
      return;
    }
  }

  OtherWay otherWay(std::size_t m, std::size_t way) const {
    OtherWay out;
    out.way = static_cast<int>(way) + 1;
    if (!maps_[m].refiner) {
      out.surface = candidates_.coarse.surface;
      out.image = maps_[m].first.image;
      return out;
    }
    RefinedSoFar map = maps_[m].refiner->soFar();
    out.surface = std::move(map.surface.surface);
    out.image = std::move(map.image);
    return out;
  }

  const LaidOutShell &a_, &b_;
  const Candidates& candidates_;
  const RefineSettings& refining_;
  const ShellMapSettings& settings_;
  const Locator onB_;
  const Points points_;                // the judge's, on A
  std::vector<JudgedCandidate> maps_;  // refined ones first, and of all the preferred one
};

}  // namespace

Points imagesOf(const std::vector<SurfacePoint>& points, const ClosedSurface& surface,
                const Layout& image, const LaidOutShell& b, const Locator& onB) {
  const Locator none(surface.triangles, image);
  const LayoutMap map({surface, image, none}, {b.surface, b.layout, onB});
  Points out;
  for (const SurfacePoint& p : points) out.push_back(map.at(p.triangle, p.barycentric).position);
  return out;
}

ShellMap judgedMapOf(const LaidOutShell& a, const LaidOutShell& b, const Candidates& candidates,
                     const RefineSettings& refining, const ShellMapSettings& settings) {
  return JudgedMaps(a, b, candidates, refining, settings).take();
}

}  // namespace innermap
