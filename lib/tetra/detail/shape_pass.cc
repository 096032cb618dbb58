#include "tetra/detail/shape_pass.h"

#include <algorithm>
#include <deque>

#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr int kHalvings = 7;
constexpr double kLeastDrawn = 1e-3;    // sine, where a vertex of the boundary is drawn in
constexpr double kNeedy = 0.035;        // sine of 2 degrees
constexpr std::size_t kMostSteps = 40;  // of a tetrahedron's descendants, a pass

class Shaper {
 public:
  Shaper(const GuideSurface& surface, const ShapePassSettings& settings, LocalCells& cells)
      : surface_(surface), settings_(settings), cells_(cells) {}

  ShapePassResult run() {
    if (settings_.connect)
      for (std::size_t v = 0; v < cells_.off.size(); ++v)
        if (cells_.off[v]) drawIn(static_cast<int>(v));
    for (int pass = 0; pass < settings_.passes; ++pass) {
      throwIfCancelled();
      std::vector<int> poor = poorTets();
      if (poor.empty()) break;
      bool changed = false;
      if (settings_.connect)
        for (const int t : poor) changed = swapFrom(t) || changed;
      std::vector<int> around;
      for (const int t : poorTets())
        around.insert(around.end(), cells_.tets[t].begin(), cells_.tets[t].end());
      std::sort(around.begin(), around.end());
      around.erase(std::unique(around.begin(), around.end()), around.end());
      for (const int v : around) changed = smooth(v) || changed;
      if (!changed) break;
    }
    return result_;
  }

 private:
  // Worst first.
  std::vector<int> poorTets() const {
    std::vector<std::pair<double, int>> found;
    for (std::size_t t = 0; t < cells_.tets.size(); ++t)
      if (cells_.alive[t])
        if (const double q = cells_.quality(static_cast<int>(t)); q < settings_.least)
          found.emplace_back(q, static_cast<int>(t));
    std::sort(found.begin(), found.end());
    std::vector<int> out;
    for (const auto& entry : found) out.push_back(entry.second);
    return out;
  }

  // Wedged where the surface creases or runs through itself, a vertex of the boundary that cannot
  // come to the surface goes, if one of its neighbours there can take its place.
  void drawIn(int v) {
    std::vector<int> neighbours;
    for (const int t : cells_.star[v])
      for (const int w : cells_.tets[t])
        if (w != v && cells_.onBoundary(w) && !cells_.off[w]) neighbours.push_back(w);
    std::sort(neighbours.begin(), neighbours.end());
    neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
    Change best;
    for (const int w : neighbours) {
      Change change = collapseBoundary(cells_, v, w);
      if (change.after > std::max(kLeastDrawn, best.after)) best = std::move(change);
    }
    if (!(best.after > kLeastDrawn)) return;
    apply(cells_, best);
    ++result_.collapses;
  }

  bool swapFrom(int first) {
    std::deque<int> open{first};
    bool changed = false;
    for (std::size_t step = 0; !open.empty() && step < kMostSteps; ++step) {
      const int t = open.front();
      open.pop_front();
      if (!cells_.alive[t] || cells_.quality(t) >= settings_.least) continue;
      const Change best = bestChange(t);
      if (!best.better()) continue;
      changed = true;
      for (const int made : apply(cells_, best)) open.push_back(made);
    }
    return changed;
  }

  Change bestChange(int t) {
    const Tetrahedron tet = cells_.tets[t];
    Change best;
    double gain = 0;
    bool collapse = false;
    const auto consider = [&](Change change, bool collapses) {
      if (!change.better() || !(change.after > gain)) return;
      gain = change.after;
      collapse = collapses;
      best = std::move(change);
    };
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) consider(removeEdge(cells_, tet[i], tet[j]), false);
    for (int i = 0; i < 4; ++i) consider(removeFace(cells_, t, i), false);
    if (!best.better())
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
          if (i != j) consider(collapseEdge(cells_, tet[i], tet[j]), true);
    if (best.better()) ++(collapse ? result_.collapses : result_.swaps);
    return best;
  }

  double worstAround(int v, double floor) const {
    double worst = 1;
    for (const int t : cells_.star[v]) {
      worst = std::min(worst, cells_.quality(t));
      if (worst <= floor) break;
    }
    return worst;
  }

  // Uphill for the worst tetrahedra, by differences.
  Vec3 directionAt(int v, double worst, double size) {
    const Vec3 here = cells_.at[v];
    const double step = 1e-4 * size;
    Vec3 direction;
    for (const int t : cells_.star[v]) {
      const double q = cells_.quality(t);
      if (q > worst + 0.05 + std::abs(worst)) continue;
      Vec3 slope;
      for (int k = 0; k < 3; ++k) {
        cells_.at[v][k] = here[k] + step;
        const double up = cells_.quality(t);
        cells_.at[v][k] = here[k] - step;
        slope[k] = (up - cells_.quality(t)) / (2 * step);
        cells_.at[v][k] = here[k];
      }
      const double length = norm(slope);
      if (!(length > 0)) continue;
      const double weight = 1 / (1e-3 + std::max(0.0, q - worst));
      direction += (weight / length) * slope;
    }
    const double length = norm(direction);
    return length > 0 ? (size / length) * direction : Vec3{};
  }

  bool tryAt(int v, const Vec3& p, double worst) {
    const Vec3 here = cells_.at[v];
    SurfacePoint place = cells_.place[v];
    Vec3 to = p;
    if (cells_.onBoundary(v)) {
      const ClosestPoint on = surface_.closestFrom(place.triangle, p);
      to = on.position;
      place = on.address;
    }
    cells_.at[v] = to;
    const double floor = 1.001 * worst + 1e-9;
    if (worstAround(v, floor) > floor) {
      cells_.place[v] = place;
      return true;
    }
    cells_.at[v] = here;
    return false;
  }

  bool smooth(int v) {
    if (!cells_.moving[v] || cells_.star[v].empty()) return false;
    bool changed = false;
    for (int round = 0; round < 3; ++round) {
      const double worst = worstAround(v, -1);
      if (worst > 1.5 * settings_.least) break;
      // Edges of the surface are left only where there is need.
      if (worst > kNeedy * settings_.least && cells_.onBoundary(v) &&
          surface_.onCrease(cells_.place[v]))
        break;
      const Vec3 here = cells_.at[v];
      Vec3 middle;
      double count = 0, size = 0;
      for (const int t : cells_.star[v])
        for (const int w : cells_.tets[t])
          if (w != v) {
            middle += cells_.at[w];
            ++count;
          }
      middle = middle / count;
      for (const int t : cells_.star[v])
        for (const int w : cells_.tets[t]) size += norm(cells_.at[w] - here);
      size /= count;
      const Vec3 uphill = directionAt(v, worst, size), inward = middle - here;
      bool moved = false;
      double share = 0.5;
      for (int k = 0; k < kHalvings && !moved; ++k, share /= 2)
        moved =
            tryAt(v, here + share * uphill, worst) || tryAt(v, here + 2 * share * inward, worst);
      changed = changed || moved;
      if (!moved) break;
    }
    return changed;
  }

  const GuideSurface& surface_;
  const ShapePassSettings& settings_;
  LocalCells& cells_;
  ShapePassResult result_;
};

}  // namespace

ShapePassResult improveShapes(const GuideSurface& surface, const ShapePassSettings& settings,
                              LocalCells& cells) {
  return Shaper(surface, settings, cells).run();
}

}  // namespace innermap
