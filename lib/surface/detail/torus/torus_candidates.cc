#include "surface/detail/torus/torus_candidates.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "innermap/core/run.h"
#include "surface/detail/refining/map_samples.h"
#include "surface/detail/refining/target_metric.h"
#include "surface/detail/torus/torus_layout.h"

namespace innermap {
namespace {

constexpr double kNormalWeight = 2, kLandmarkWeight = 10;
constexpr double kApart = 0.35;                             // in the plane, between candidates kept
constexpr std::size_t kRefined = 24, kRefinedOfOneMap = 6;  // of the grid's best
constexpr double kFinest = 0.004;                           // step of the refinement, in periods

// x -> column[0] x.x + column[1] x.y, z untouched.
struct Linear {
  Vec3 column[2];
  Vec3 operator()(const Vec3& d) const { return d.x * column[0] + d.y * column[1]; }
  Vec3 point(const Vec3& p) const {
    Vec3 q = (*this)(p);
    q.z = p.z;
    return q;
  }
};

// The linear map of the plane with p[0] -> q[0], p[1] -> q[1].
Linear linearMap(const std::array<Vec3, 2>& p, const std::array<Vec3, 2>& q) {
  const double det = p[0].x * p[1].y - p[0].y * p[1].x;
  return {{(p[1].y / det) * q[0] - (p[0].y / det) * q[1],
           (p[0].x / det) * q[1] - (p[1].x / det) * q[0]}};
}

struct LatticeMap {
  bool reversed = false;
  int twist = 0;
  Linear forth, back;

  LatticeMap(const Layout& a, const Layout& b, bool isReversed, int twists)
      : reversed(isReversed), twist(twists) {
    const double sign = reversed ? -1 : 1;
    const std::array<Vec3, 2> images{sign * b.period[0],
                                     sign * b.period[1] + static_cast<double>(twist) * b.period[0]};
    forth = linearMap(a.period, images);
    back = linearMap(images, a.period);
  }
  Shift operator()(const Shift& s) const {
    const int sign = reversed ? -1 : 1;
    return {sign * s.a + twist * s.b, sign * s.b};
  }
};

struct Trial {
  std::size_t map = 0;  // of the lattice
  Vec3 move;            // after it
  double fit = 0;       // of landmarks
  double cost = std::numeric_limits<double>::infinity();
};

// d less the lattice vector nearest to it; the lattice's basis is a short one.
Vec3 reduced(const Vec3& d, const std::array<Vec3, 2>& period) {
  const double det = period[0].x * period[1].y - period[0].y * period[1].x;
  const double u = (d.x * period[1].y - d.y * period[1].x) / det,
               v = (period[0].x * d.y - period[0].y * d.x) / det;
  return d - (std::round(u) * period[0] + std::round(v) * period[1]);
}

// Samples of one surface carried onto another.
struct Side {
  std::vector<MapSample> samples;
  TargetMetric target;
  Points normals;  // of the target's triangles
};

class Search {
 public:
  Search(const ClosedSurface& a, const Layout& la, const ClosedSurface& b, const Layout& lb,
         const TorusSearch& settings)
      : settings_(settings),
        period_(lb.period),
        onB_{sampleSource(a, la, settings.samples, settings.seed), TargetMetric(b, lb),
             unitNormals(b)},
        onA_{sampleSource(b, lb, settings.samples, settings.seed), TargetMetric(a, la),
             unitNormals(a)} {
    for (int twist = -settings.twists; twist <= settings.twists; ++twist)
      for (const bool reversed : {false, true}) maps_.emplace_back(la, lb, reversed, twist);
  }

  std::vector<Trial> run() const {
    std::vector<Trial> trials = settings_.landmarks.empty() ? gridTrials() : landmarkTrials();
    evaluate(trials, "trying places on the torus");
    sort(trials);
    if (settings_.landmarks.empty()) {
      trials = localBest(trials);
      parallelBlocks(
          trials.size(), 1,
          [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) descend(trials[i]);
          },
          "moving the best");
      sort(trials);
    }
    std::vector<Trial> kept;
    for (const Trial& t : trials)
      if (kept.size() < settings_.count && differs(t, kept, kApart)) kept.push_back(t);
    return kept;
  }

  const LatticeMap& map(const Trial& t) const { return maps_[t.map]; }

 private:
  static void sort(std::vector<Trial>& trials) {
    std::stable_sort(trials.begin(), trials.end(),
                     [](const Trial& x, const Trial& y) { return x.cost < y.cost; });
  }

  bool differs(const Trial& t, const std::vector<Trial>& others, double apart) const {
    return std::none_of(others.begin(), others.end(), [&](const Trial& o) {
      return o.map == t.map && norm(reduced(o.move - t.move, period_)) < apart;
    });
  }

  std::vector<Trial> gridTrials() const {
    std::vector<Trial> trials;
    for (std::size_t m = 0; m < maps_.size(); ++m)
      for (int i = 0; i < settings_.grid; ++i)
        for (int j = 0; j < settings_.grid; ++j) {
          Trial t;
          t.map = m;
          t.move = (static_cast<double>(i) / settings_.grid) * period_[0] +
                   (static_cast<double>(j) / settings_.grid) * period_[1];
          trials.push_back(t);
        }
    return trials;
  }

  // Of each lattice map the translation of least squares, for the periods that fit it best.
  std::vector<Trial> landmarkTrials() const {
    std::vector<Trial> trials;
    for (std::size_t m = 0; m < maps_.size(); ++m) {
      Trial best;
      best.map = m;
      best.fit = std::numeric_limits<double>::infinity();
      for (const auto& first : settings_.landmarks) {
        Vec3 move = first.second - maps_[m].forth.point(first.first);
        double squares = 0;
        for (int round = 0; round < 4; ++round) {
          Vec3 mean;
          squares = 0;
          for (const auto& [from, to] : settings_.landmarks) {
            const Vec3 rest = reduced(to - maps_[m].forth.point(from) - move, period_);
            mean += rest;
            squares += squaredNorm(rest);
          }
          const double n = static_cast<double>(settings_.landmarks.size());
          squares = squares / n - squaredNorm(mean / n);
          move += mean / n;
        }
        if (squares < best.fit) {
          best.fit = squares;
          best.move = move;
        }
      }
      trials.push_back(best);
    }
    return trials;
  }

  double costOn(const Side& side, const Linear& linear, const Vec3& before,
                const Vec3& after) const {
    double sum = 0;
    for (const MapSample& s : side.samples) {
      const Vec3 x = linear.point(s.x + before) + after;
      Locator::Weights weights;
      const Located where = side.target.locator().find(x, weights);
      const TargetMetric::Plane p = side.target.project(where, weights, linear(s.e), linear(s.f));
      const Stretch stretch{p.e.x * p.e.x + p.e.y * p.e.y + p.f.x * p.f.x + p.f.y * p.f.y, p.det()};
      sum += stretch.logSquared();
      if (settings_.aligned)
        sum += kNormalWeight * (1 - dot(s.normal, side.normals[where.triangle]));
    }
    return sum / static_cast<double>(std::max<std::size_t>(side.samples.size(), 1));
  }

  double costOf(const Trial& t) const {
    const LatticeMap& m = maps_[t.map];
    return 0.5 * (costOn(onB_, m.forth, {}, t.move) + costOn(onA_, m.back, -t.move, {})) +
           kLandmarkWeight * t.fit;
  }

  void evaluate(std::vector<Trial>& trials, std::string_view stage) const {
    parallelBlocks(
        trials.size(), 32,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) trials[i].cost = costOf(trials[i]);
        },
        stage);
  }

  // The grid's best that are not next to a better one.
  std::vector<Trial> localBest(const std::vector<Trial>& sorted) const {
    const double step =
        1.5 * std::max(norm(period_[0]), norm(period_[1])) / std::max(settings_.grid, 1);
    std::vector<Trial> best;
    std::vector<std::size_t> ofMap(maps_.size(), 0);
    for (const Trial& t : sorted) {
      if (best.size() == kRefined) break;
      if (ofMap[t.map] == kRefinedOfOneMap || !differs(t, best, step)) continue;
      ++ofMap[t.map];
      best.push_back(t);
    }
    return best;
  }

  void descend(Trial& t) const {
    for (double step = 0.5 / settings_.grid; step > kFinest;) {
      Trial best = t;
      for (const Vec3& direction : period_)
        for (const double sign : {-1.0, 1.0}) {
          Trial next = t;
          next.move += (sign * step) * direction;
          next.cost = costOf(next);
          if (next.cost < best.cost) best = next;
        }
      if (best.cost < t.cost)
        t = best;
      else
        step *= 0.5;
    }
  }

  const TorusSearch& settings_;
  std::array<Vec3, 2> period_;
  Side onB_, onA_;
  std::vector<LatticeMap> maps_;
};

}  // namespace

std::vector<TorusCandidate> torusCandidates(const ClosedSurface& a, const Layout& layoutOfA,
                                            const ClosedSurface& b, const Layout& layoutOfB,
                                            const TorusSearch& settings) {
  const Search search(a, layoutOfA, b, layoutOfB, settings);
  std::vector<TorusCandidate> out;
  for (const Trial& trial : search.run()) {
    const LatticeMap& map = search.map(trial);
    TorusCandidate candidate;
    candidate.cost = trial.cost;
    candidate.reversed = map.reversed;
    candidate.twist = map.twist;
    Layout& image = candidate.image;
    image = layoutOfA;
    image.period = layoutOfB.period;
    for (Vec3& p : image.place) p = map.forth.point(p) + trial.move;
    for (CornerShifts& corners : image.shift)
      for (Shift& s : corners) s = map(s);
    moveIntoCell(a.triangles, image);
    out.push_back(std::move(candidate));
  }
  return out;
}

}  // namespace innermap
