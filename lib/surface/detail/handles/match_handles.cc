#include "surface/detail/handles/match_handles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/random.h"
#include "innermap/core/run.h"
#include "surface/detail/refining/target_metric.h"
#include "surface/detail/sphere/rotation_search.h"
#include "surface/detail/topology/edge_distance.h"

namespace innermap {
namespace {

constexpr std::size_t kExhaustive = 6, kStarts = 64;
constexpr double kMatchLengthWeight = 0.5, kSphereWeight = 1, kMatchLandmarkWeight = 10,
                 kMatchPlaceWeight = 10;

// What a match is judged by: cap 2 i + s is that of handle i on side s.
struct Caps {
  std::vector<std::vector<double>> distance;  // logarithms of those along edges between caps
  std::vector<double> length;                 // logarithms of the rims' lengths
  Points place;                               // on the sphere
  Points position;                            // about the box's centre, over its diagonal
};

Caps capsOf(const CutSurface& cut, const Layout& layout) {
  const ClosedSurface& surface = cut.surface;
  const EdgeDistance distanceFrom(surface);
  const double scale = unitAreaScale(surface.vertices, surface.triangles);
  const Box3 box = boundingBox(surface.vertices);
  Caps caps;
  for (const CutHandle& handle : cut.handles) {
    for (std::size_t side = 0; side < 2; ++side) {
      throwIfCancelled();
      const std::vector<int>& rim = handle.loop[side];
      const std::vector<double> distance = distanceFrom(rim);
      std::vector<double> row;
      for (const CutHandle& other : cut.handles) {
        for (const std::vector<int>& rimThere : other.loop) {
          double least = std::numeric_limits<double>::infinity();
          for (const int v : rimThere) least = std::min(least, distance[v]);
          row.push_back(std::log(scale * least + 0.02));  // rims may nearly touch
        }
      }
      caps.distance.push_back(std::move(row));
      double length = 0;
      for (std::size_t i = 0; i < rim.size(); ++i)
        length += norm(surface.vertices[rim[(i + 1) % rim.size()]] - surface.vertices[rim[i]]);
      caps.length.push_back(std::log(scale * length + 1e-6));
      caps.place.push_back(layout.place[handle.centre[side]]);
      caps.position.push_back((surface.vertices[handle.centre[side]] - box.center()) /
                              std::max(box.diagonal(), 1e-300));
    }
  }
  return caps;
}

class HandleMatcher {
 public:
  HandleMatcher(Caps a, Caps b, const HandleSearch& settings)
      : a_(std::move(a)), b_(std::move(b)), settings_(settings) {}

  void judge(HandleMatch& m) const {
    const std::size_t n = a_.place.size();
    std::vector<std::size_t> to(n);
    for (std::size_t i = 0; i < n; ++i)
      to[i] = 2 * static_cast<std::size_t>(m.target[i / 2]) +
              (i % 2 == 0) * (m.swapped[i / 2] != 0) + (i % 2 == 1) * (m.swapped[i / 2] == 0);
    double distances = 0, lengths = 0, sphere = 0, places = 0;
    Points from = a_.place, targets;
    for (std::size_t i = 0; i < n; ++i) {
      targets.push_back(b_.place[to[i]]);
      lengths += std::pow(a_.length[i] - b_.length[to[i]], 2);
      places += squaredNorm(a_.position[i] - b_.position[to[i]]);
      for (std::size_t j = 0; j < i; ++j)
        distances += std::pow(a_.distance[i][j] - b_.distance[to[i]][to[j]], 2);
    }
    for (const auto& [x, y] : settings_.landmarks) {
      // Counted more than caps are, by repetition.
      for (int k = 0; k < 4; ++k) {
        from.push_back(x);
        targets.push_back(y);
      }
    }
    m.rotation = bestRotation(from, targets);
    for (std::size_t i = 0; i < n; ++i)
      sphere += squaredNorm(m.rotation * from[i] - targets[i]) / static_cast<double>(n);
    double landmarks = 0;
    for (const auto& [x, y] : settings_.landmarks)
      landmarks +=
          squaredNorm(m.rotation * x - y) / static_cast<double>(settings_.landmarks.size());
    const double count = static_cast<double>(n);
    m.cost = 2 * distances / (count * (count - 1)) + kMatchLengthWeight * lengths / count +
             kSphereWeight * sphere + kMatchLandmarkWeight * landmarks;
    if (settings_.aligned) m.cost += kMatchPlaceWeight * places / count;
  }

  std::vector<HandleMatch> run() const {
    const std::size_t g = a_.place.size() / 2;
    std::vector<HandleMatch> all;
    HandleMatch m;
    m.target.resize(g);
    m.swapped.assign(g, 0);
    std::iota(m.target.begin(), m.target.end(), 0);
    if (g <= kExhaustive) {
      do {
        throwIfCancelled();
        for (unsigned sides = 0; sides < 1u << g; ++sides) {
          for (std::size_t i = 0; i < g; ++i) m.swapped[i] = (sides >> i & 1u) != 0;
          judge(m);
          keep(all, m);
        }
      } while (std::next_permutation(m.target.begin(), m.target.end()));
    } else {
      for (std::size_t start = 0; start < kStarts; ++start) keep(all, descended(m, start));
    }
    return all;
  }

 private:
  void keep(std::vector<HandleMatch>& best, const HandleMatch& m) const {
    const auto same = [&](const HandleMatch& o) {
      return o.target == m.target && o.swapped == m.swapped;
    };
    if (std::any_of(best.begin(), best.end(), same)) return;
    const auto at = std::upper_bound(
        best.begin(), best.end(), m,
        [](const HandleMatch& x, const HandleMatch& y) { return x.cost < y.cost; });
    if (at == best.end() && best.size() >= settings_.count) return;
    best.insert(at, m);
    if (best.size() > settings_.count) best.pop_back();
  }

  // From a random match, by swapping two targets or the sides of one handle.
  HandleMatch descended(HandleMatch m, std::size_t start) const {
    const CounterRandom random(start, 0x68616e64);
    const std::size_t g = m.target.size();
    for (std::size_t i = g; i-- > 1;) std::swap(m.target[i], m.target[random.bits(i) % (i + 1)]);
    for (std::size_t i = 0; i < g; ++i) m.swapped[i] = static_cast<char>(random.bits(g + i) & 1);
    judge(m);
    for (bool better = true; better;) {
      throwIfCancelled();
      better = false;
      const auto take = [&](HandleMatch& next) {
        judge(next);
        if (!(next.cost < m.cost)) return;
        m = next;
        better = true;
      };
      for (std::size_t i = 0; i < g; ++i) {
        HandleMatch next = m;
        next.swapped[i] = !next.swapped[i];
        take(next);
        for (std::size_t j = 0; j < i; ++j) {
          next = m;
          std::swap(next.target[i], next.target[j]);
          take(next);
        }
      }
    }
    return m;
  }

  Caps a_, b_;
  const HandleSearch& settings_;
};

}  // namespace

std::vector<HandleMatch> matchHandles(const CutSurface& a, const Layout& layoutOfA,
                                      const CutSurface& b, const Layout& layoutOfB,
                                      const HandleSearch& settings) {
  return HandleMatcher(capsOf(a, layoutOfA), capsOf(b, layoutOfB), settings).run();
}

}  // namespace innermap
