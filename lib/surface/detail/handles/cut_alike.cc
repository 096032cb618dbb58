#include "surface/detail/handles/cut_alike.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "innermap/core/run.h"
#include "surface/detail/refining/target_metric.h"
#include "surface/detail/sphere/sphere_layout.h"
#include "surface/detail/topology/edge_distance.h"
#include "surface/detail/topology/homology.h"

namespace innermap {
namespace {

constexpr double kLengthWeight = 0.5, kLandmarkWeight = 2, kPlaceWeight = 10;
constexpr double kClear = 0.3, kClearLeast = 0.12;  // by how much the second best must be worse
constexpr double kSamePlace = 0.05;                 // of the diagonal: cuts next to one another
constexpr int kMostTrials = 200000;

// Of loops on the uncut surface, scaled to unit area.
struct LoopFeatures {
  std::vector<std::vector<double>> distance;    // logarithms, between loops
  std::vector<std::vector<double>> toLandmark;  // logarithms
  std::vector<double> length;                   // logarithms
  Points position;                              // about the box's centre, over its diagonal
};

LoopFeatures featuresOf(const HandleLoops& loops, std::size_t count,
                        const std::vector<int>& landmarks) {
  const ClosedSurface& surface = loops.uncut.surface;
  const EdgeDistance distanceFrom(surface);
  const double scale = unitAreaScale(surface.vertices, surface.triangles);
  const auto logarithm = [scale](double d) { return std::log(scale * d + 0.02); };
  const Box3 box = boundingBox(surface.vertices);
  LoopFeatures out;
  for (std::size_t i = 0; i < count; ++i) {
    throwIfCancelled();
    const std::vector<int>& loop = loops.loops[i];
    const std::vector<double> distance = distanceFrom(loop);
    out.distance.emplace_back();
    for (std::size_t j = 0; j < count; ++j) {
      double least = std::numeric_limits<double>::infinity();
      for (const int v : loops.loops[j]) least = std::min(least, distance[v]);
      out.distance.back().push_back(logarithm(least));
    }
    out.toLandmark.emplace_back();
    for (const int v : landmarks) out.toLandmark.back().push_back(logarithm(distance[v]));
    double length = 0;
    Vec3 mean;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec3& p = surface.vertices[loop[k]];
      length += norm(surface.vertices[loop[(k + 1) % loop.size()]] - p);
      mean += p / static_cast<double>(loop.size());
    }
    out.length.push_back(logarithm(length));
    out.position.push_back((mean - box.center()) / std::max(box.diagonal(), 1e-300));
  }
  return out;
}

// Assigns A's loops to B's, depth first, the least cost of each set of B's kept.
class SystemSearch {
 public:
  SystemSearch(const LoopFeatures& a, const LoopFeatures& b, const HandleLoops& loops, bool aligned)
      : a_(a), b_(b), loops_(loops), aligned_(aligned) {
    descend(0);
  }

  // Sets of B's loops, the best first.
  std::vector<std::vector<int>> best(std::size_t count) const {
    std::vector<std::pair<double, std::vector<int>>> sorted;
    for (const auto& [set, cost] : costs_) sorted.push_back({cost, set});
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::vector<int>> out;
    for (const auto& [cost, set] : sorted) {
      if (out.size() == count) break;
      IntegerMatrix classes;
      for (const int i : set) classes.push_back(loops_.classes[static_cast<std::size_t>(i)]);
      if (leftKernel(classes).empty()) out.push_back(set);
    }
    return out;
  }

 private:
  void descend(double cost) {
    if (chosen_.size() == a_.length.size()) {
      std::vector<int> set = chosen_;
      std::sort(set.begin(), set.end());
      const auto [found, isNew] = costs_.try_emplace(std::move(set), cost);
      if (!isNew) found->second = std::min(found->second, cost);
      return;
    }
    for (int j = 0; j < static_cast<int>(b_.length.size()) && trials_ < kMostTrials; ++j) {
      if (std::find(chosen_.begin(), chosen_.end(), j) != chosen_.end()) continue;
      ++trials_;
      const double more = costOf(chosen_.size(), static_cast<std::size_t>(j));
      chosen_.push_back(j);
      descend(cost + more);
      chosen_.pop_back();
    }
  }

  double costOf(std::size_t i, std::size_t j) const {
    const auto square = [](double x) { return x * x; };
    const double count = static_cast<double>(a_.length.size());
    double cost = kLengthWeight * square(a_.length[i] - b_.length[j]) / count;
    for (std::size_t k = 0; k < chosen_.size(); ++k)
      cost += 2 * square(a_.distance[i][k] - b_.distance[j][static_cast<std::size_t>(chosen_[k])]) /
              (count * count);
    for (std::size_t k = 0; k < a_.toLandmark[i].size(); ++k)
      cost += kLandmarkWeight * square(a_.toLandmark[i][k] - b_.toLandmark[j][k]) /
              (count * static_cast<double>(a_.toLandmark[i].size()));
    if (aligned_) cost += kPlaceWeight * squaredNorm(a_.position[i] - b_.position[j]) / count;
    return cost;
  }

  const LoopFeatures &a_, &b_;
  const HandleLoops& loops_;
  bool aligned_;
  int trials_ = 0;
  std::vector<int> chosen_;
  std::map<std::vector<int>, double> costs_;
};

int nearestVertex(const ClosedSurface& surface, const SurfacePoint& p) {
  const auto& w = p.barycentric;
  const auto k = static_cast<std::size_t>(std::max_element(w.begin(), w.end()) - w.begin());
  return surface.triangles[static_cast<std::size_t>(p.triangle)][k];
}

// Where a match sends A's handles.
struct Outcome {
  double cost = 0;
  Points centre;  // of the handles of B, for each of A's
  std::vector<char> swapped;
};

Outcome outcomeOf(const CutSurface& b, const HandleMatch& match) {
  Outcome out{match.cost, {}, match.swapped};
  for (const int i : match.target)
    out.centre.push_back(b.surface.vertices[b.handles[static_cast<std::size_t>(i)].centre[0]]);
  return out;
}

// Empty when the best outcome is clearly so; else which landmarks would decide, for people.
std::string ambiguity(const CutSurface& a, const CutSurface& b, std::vector<Outcome> outcomes) {
  std::stable_sort(outcomes.begin(), outcomes.end(),
                   [](const Outcome& x, const Outcome& y) { return x.cost < y.cost; });
  const Outcome& best = outcomes.at(0);
  const double same = kSamePlace * boundingBox(b.surface.vertices).diagonal();
  const auto text = [](const Vec3& p) {
    return fmt::format("({:.4g}, {:.4g}, {:.4g})", p.x, p.y, p.z);
  };
  for (const Outcome& next : outcomes) {
    if (next.cost > (1 + kClear) * best.cost + kClearLeast) break;
    for (std::size_t i = 0; i < best.centre.size(); ++i) {
      const Vec3 &from = a.surface.vertices[a.handles[i].centre[0]], &to = best.centre[i];
      if (norm(next.centre[i] - to) > same)
        return fmt::format(
            "whether the handle of {} at {} goes to that of {} at {} or at {} is nearly a tie; "
            "landmarks beside it would decide",
            a.surface.name, text(from), b.surface.name, text(to), text(next.centre[i]));
    }
    // A loop's direction is arbitrary: sides are told from one another within one system of loops.
    for (std::size_t i = 0; i < best.centre.size(); ++i)
      if (norm(next.centre[i] - best.centre[i]) <= 0 && next.swapped[i] != best.swapped[i])
        return fmt::format(
            "which way round the handle of {} at {} goes onto that of {} at {} is nearly a tie; "
            "landmarks on both sides of it would decide",
            a.surface.name, text(a.surface.vertices[a.handles[i].centre[0]]), b.surface.name,
            text(best.centre[i]));
  }
  return {};
}

}  // namespace

CutPair cutAlike(const HandleLoops& a, const HandleLoops& b, const CutAlikeSettings& settings) {
  CutPair out;
  std::vector<int> first(a.handles);
  std::iota(first.begin(), first.end(), 0);
  out.a = cutAlong(a, first);
  out.layoutOfA = layOutSphere(out.a.surface);

  std::vector<SurfacePoint> onB;
  std::vector<int> ofA, nearB;
  for (const auto& [v, p] : settings.landmarks) {
    ofA.push_back(v);
    onB.push_back(p);
  }
  for (const SurfacePoint& p : onCut(b.uncut, onB))
    nearB.push_back(nearestVertex(b.uncut.surface, p));
  std::vector<std::vector<int>> systems =
      SystemSearch(featuresOf(a, a.handles, ofA), featuresOf(b, b.loops.size(), nearB), b,
                   settings.aligned)
          .best(std::max<std::size_t>(settings.systems, 1) - 1);
  if (std::find(systems.begin(), systems.end(), first) == systems.end()) systems.push_back(first);

  double least = std::numeric_limits<double>::infinity();
  std::vector<Outcome> outcomes;
  for (const std::vector<int>& system : systems) {
    CutSurface cut = cutAlong(b, system);
    Layout layout = layOutSphere(cut.surface);
    HandleSearch search;
    search.aligned = settings.aligned;
    const std::vector<SurfacePoint> there = onCut(cut, onB);
    // The first copy of a vertex has its own number.
    for (std::size_t i = 0; i < there.size(); ++i)
      search.landmarks.push_back(
          {out.layoutOfA.place[ofA[i]], placeOnSphere(cut.surface, layout, there[i])});
    const std::vector<HandleMatch> matches =
        matchHandles(out.a, out.layoutOfA, cut, layout, search);
    for (const HandleMatch& m : matches) outcomes.push_back(outcomeOf(cut, m));
    if (!(matches.at(0).cost < least)) continue;
    least = matches[0].cost;
    out.match = matches[0];
    out.b = std::move(cut);
    out.layoutOfB = std::move(layout);
  }
  out.note = ambiguity(out.a, out.b, std::move(outcomes));
  return out;
}

}  // namespace innermap
