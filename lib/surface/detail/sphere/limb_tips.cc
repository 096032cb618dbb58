#include "surface/detail/sphere/limb_tips.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "innermap/core/run.h"
#include "surface/detail/refining/decimate.h"
#include "surface/detail/refining/target_metric.h"
#include "surface/detail/sphere/rotation_search.h"

namespace innermap {
namespace {

constexpr std::size_t kMostTips = 8;
constexpr double kTolerance = 0.35;  // of the logarithm of ratios of distances
constexpr double kTipMisfit = 0.6;   // radians, of matched tips after the best rotation
constexpr double kApart = 0.12;      // of the root of the area: tips nearer than that are one

struct Graph {
  std::vector<int> vertex;  // of the surface
  std::vector<double> area;
  std::vector<std::vector<std::pair<int, double>>> edges;
};

// Length of the straight way from a to b across the edge p q, both triangles unfolded into a plane;
// infinite where it does not cross the edge.
double acrossEdge(const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q) {
  const double l = norm(q - p);
  if (!(l > 0)) return std::numeric_limits<double>::infinity();
  const Vec3 u = (q - p) / l;
  const double xa = dot(a - p, u), xb = dot(b - p, u);
  const double ya = norm(a - p - xa * u), yb = norm(b - p - xb * u);
  const double x = ya + yb > 0 ? xa + (xb - xa) * ya / (ya + yb) : xa;
  if (x < 0 || x > l) return std::numeric_limits<double>::infinity();
  return std::hypot(xb - xa, ya + yb);
}

Graph graphOf(const ProgressiveMesh& mesh, const Points& points) {
  Graph g;
  std::vector<int> node(mesh.capacity(), -1);
  for (int v = 0; v < static_cast<int>(mesh.capacity()); ++v)
    if (mesh.present(v)) {
      node[v] = static_cast<int>(g.vertex.size());
      g.vertex.push_back(v);
    }
  g.area.assign(g.vertex.size(), 0);
  g.edges.resize(g.vertex.size());
  Ring ring;
  for (const int v : g.vertex) {
    mesh.ring(v, ring);
    const std::size_t n = ring.size();
    const Vec3& p = points[v];
    for (std::size_t i = 0; i < n; ++i) {
      const int w = ring[i].vertex, before = ring[(i + n - 1) % n].vertex,
                after = ring[(i + 1) % n].vertex;
      g.edges[node[v]].push_back({node[w], norm(points[w] - p)});
      g.area[node[v]] += norm(cross(points[w] - p, points[after] - p)) / 6;
      // Across the edge v w, between the two vertices beside it.
      const double l = acrossEdge(points[before], points[after], p, points[w]);
      if (l < std::numeric_limits<double>::infinity()) {
        g.edges[node[before]].push_back({node[after], l});
        g.edges[node[after]].push_back({node[before], l});
      }
    }
  }
  return g;
}

std::vector<double> distancesFrom(const Graph& g, int start) {
  std::vector<double> d(g.vertex.size(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
  d[start] = 0;
  queue.push({0, start});
  while (!queue.empty()) {
    const auto [length, v] = queue.top();
    queue.pop();
    if (length > d[v]) continue;
    for (const auto& [w, l] : g.edges[v])
      if (length + l < d[w]) {
        d[w] = length + l;
        queue.push({d[w], w});
      }
  }
  return d;
}

class Matcher {
 public:
  Matcher(const LimbTips& a, const LimbTips& b) : a_(a), b_(b), used_(b.vertices.size(), false) {}

  std::vector<std::pair<double, TipPairs>> run() {
    visit(0, 0);
    std::stable_sort(found_.begin(), found_.end(),
                     [](const auto& x, const auto& y) { return x.first > y.first; });
    return std::move(found_);
  }

 private:
  // What the pair adds to the score of those chosen so far.
  double gain(int i, int j) const {
    double g = kTolerance - std::abs(std::log(a_.centrality[i] / b_.centrality[j]));
    for (const auto& [p, q] : pairs_)
      g += kTolerance - std::abs(std::log(a_.distance[i][p] / b_.distance[j][q]));
    for (std::size_t m = 0; m < pairs_.size(); ++m)
      for (std::size_t n = 0; n < m; ++n) {
        const double da = tripleProduct(a_.place[i], a_.place[pairs_[m].first],
                                        a_.place[pairs_[n].first]),
                     db = tripleProduct(b_.place[j], b_.place[pairs_[m].second],
                                        b_.place[pairs_[n].second]);
        if (da * db < 0 && std::min(std::abs(da), std::abs(db)) > 0.1) g -= kTolerance;
      }
    return g;
  }

  void visit(std::size_t i, double score) {
    if (i == a_.vertices.size()) {
      if (pairs_.size() >= 3) keep(score);
      return;
    }
    for (std::size_t j = 0; j < b_.vertices.size(); ++j) {
      if (used_[j]) continue;
      const double g = gain(static_cast<int>(i), static_cast<int>(j));
      // One that fits none of the others is better left out.
      if (g < -kTolerance * static_cast<double>(pairs_.size() + 1)) continue;
      used_[j] = true;
      pairs_.push_back({static_cast<int>(i), static_cast<int>(j)});
      visit(i + 1, score + g);
      pairs_.pop_back();
      used_[j] = false;
    }
    visit(i + 1, score);
  }

  void keep(double score) {
    if (found_.size() >= 4000) {
      if (score <= bound_) return;
      std::nth_element(found_.begin(), found_.begin() + 1000, found_.end(),
                       [](const auto& x, const auto& y) { return x.first > y.first; });
      found_.resize(1000);
      bound_ = std::min_element(found_.begin(), found_.end(), [](const auto& x, const auto& y) {
                 return x.first < y.first;
               })->first;
    }
    found_.push_back({score, pairs_});
  }

  const LimbTips &a_, &b_;
  std::vector<bool> used_;
  TipPairs pairs_;
  std::vector<std::pair<double, TipPairs>> found_;
  double bound_ = -1e300;
};

}  // namespace

LimbTips limbTips(const ClosedSurface& surface, const Layout& layout, std::size_t vertices) {
  ProgressiveMesh mesh(surface.vertices.size(), surface.triangles, layout.shift);
  DecimateSettings coarse;
  coarse.vertices = vertices;
  decimate(mesh, surface.vertices, coarse);
  Points points = surface.vertices;
  const double scale = unitAreaScale(surface.vertices, surface.triangles);
  for (Vec3& p : points) p = scale * p;
  const Graph graph = graphOf(mesh, points);
  const std::size_t n = graph.vertex.size();
  std::vector<std::vector<double>> distance(n);
  std::vector<double> average(n, 0);
  double area = 0;
  for (const double a : graph.area) area += a;
  parallelBlocks(
      n, 16,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
          distance[v] = distancesFrom(graph, static_cast<int>(v));
          for (std::size_t w = 0; w < n; ++w) average[v] += graph.area[w] * distance[v][w] / area;
        }
      },
      "finding limbs");
  std::vector<int> order(n);
  for (std::size_t v = 0; v < n; ++v) order[v] = static_cast<int>(v);
  std::stable_sort(order.begin(), order.end(),
                   [&](int x, int y) { return average[x] > average[y]; });
  std::vector<int> tips;
  for (const int v : order) {
    if (tips.size() == kMostTips) break;
    bool highest = true;
    for (std::size_t w = 0; w < n; ++w)
      if (distance[v][w] < kApart && average[w] > average[v]) highest = false;
    if (highest) tips.push_back(v);
  }
  LimbTips out;
  for (const int v : tips) {
    out.vertices.push_back(graph.vertex[v]);
    out.centrality.push_back(average[v]);
    out.place.push_back(layout.place[graph.vertex[v]]);
    out.distance.emplace_back();
    for (const int w : tips) out.distance.back().push_back(distance[v][w]);
  }
  return out;
}

std::vector<TipPairs> matchTips(const LimbTips& a, const LimbTips& b, std::size_t most) {
  std::vector<TipPairs> out;
  for (const auto& [score, pairs] : Matcher(a, b).run()) {
    if (out.size() == most) break;
    Points from, to;
    for (const auto& [i, j] : pairs) {
      from.push_back(a.place[i]);
      to.push_back(b.place[j]);
    }
    if (rotationMisfit(bestRotation(from, to), from, to) > kTipMisfit) continue;
    out.push_back(pairs);
  }
  return out;
}

}  // namespace innermap
