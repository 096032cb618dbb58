#include "mesh/uv_charts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <queue>

#include "core/disjoint_sets.h"
#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "mesh/detail/topology.h"

namespace innermap {
namespace {

constexpr double kSameUv = 1e-6;  // of the coordinates' extent
constexpr int kFewestGroups = 2, kMostGroups = 64;
constexpr double kFar = std::numeric_limits<double>::infinity();

bool hasUv(const Mesh& mesh, int triangle) {
  const Triangle& t = mesh.uvTriangles[triangle];
  for (const int uv : t)
    if (uv < 0 || !std::isfinite(mesh.uvs[uv].x) || !std::isfinite(mesh.uvs[uv].y)) return false;
  return true;
}

double uvTolerance(const Mesh& mesh) {
  double extent = 0;
  for (int c = 0; c < 2; ++c) {
    double lower = kFar, upper = -kFar;
    for (const Vec2& uv : mesh.uvs) {
      const double x = c == 0 ? uv.x : uv.y;
      if (!std::isfinite(x)) continue;
      lower = std::min(lower, x);
      upper = std::max(upper, x);
    }
    extent = std::max(extent, upper - lower);
  }
  return kSameUv * extent;
}

// Whether the coordinates agree at both ends of an edge.
class Agreement {
 public:
  explicit Agreement(const Mesh& mesh) : mesh_(mesh), tolerance_(uvTolerance(mesh)) {}

  bool operator()(const EdgeUse& a, const EdgeUse& b) const {
    return same(at(a, true), at(b, true)) && same(at(a, false), at(b, false));
  }

 private:
  int at(const EdgeUse& use, bool low) const {
    const int next = (use.corner + 1) % 3;
    return mesh_.uvTriangles[use.triangle][use.forward == low ? use.corner : next];
  }
  bool same(int i, int j) const {
    if (i == j) return true;
    const Vec2 &p = mesh_.uvs[i], &q = mesh_.uvs[j];
    return std::abs(p.x - q.x) <= tolerance_ && std::abs(p.y - q.y) <= tolerance_;
  }

  const Mesh& mesh_;
  double tolerance_;
};

// The uses of an edge by triangles that have coordinates, and whether
// neighbours among them agree.
using PairVisitor = std::function<void(const EdgeUse&, const EdgeUse&, bool agree)>;

void forEachUvPair(const Mesh& mesh, const PairVisitor& visit, double* edgeLength = nullptr) {
  const Agreement agree(mesh);
  const std::vector<int> joined = joinedVertices(mesh.vertices, mesh.triangles);
  const std::vector<EdgeUse> edges = sortedEdges(mapped(mesh.triangles, joined));
  forEachEdge(edges, [&](const EdgeUse* begin, const EdgeUse* end) {
    if (edgeLength) *edgeLength += norm(mesh.vertices[begin->high] - mesh.vertices[begin->low]);
    const EdgeUse* last = nullptr;
    for (const EdgeUse* use = begin; use != end; ++use) {
      if (!hasUv(mesh, use->triangle)) continue;
      if (last) visit(*last, *use, agree(*last, *use));
      last = use;
    }
  });
}

// A chart's triangles and the ways between neighbours, by the distance of their
// centroids.
class ChartGraph {
 public:
  explicit ChartGraph(const Mesh& mesh) : start_(mesh.triangles.size() + 1, 0) {
    std::vector<std::pair<int, int>> pairs;
    forEachUvPair(mesh, [&](const EdgeUse& a, const EdgeUse& b, bool agree) {
      if (agree) pairs.emplace_back(a.triangle, b.triangle);
    });
    for (const auto& [a, b] : pairs) {
      ++start_[a + 1];
      ++start_[b + 1];
    }
    std::partial_sum(start_.begin(), start_.end(), start_.begin());
    to_.resize(2 * pairs.size());
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    for (const auto& [a, b] : pairs) {
      to_[next[a]++] = b;
      to_[next[b]++] = a;
    }
    centroids_.reserve(mesh.triangles.size());
    distance.assign(mesh.triangles.size(), kFar);
    mark.assign(mesh.triangles.size(), 0);
    for (const Triangle& t : mesh.triangles)
      centroids_.push_back((mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3);
  }

  // The triangles of the piece of the starts, each with the mark of the start that is nearest along
  // the piece and its distance. Dijkstra's algorithm; ties by index.
  struct Start {
    int triangle;
    char mark;
  };
  void spread(const std::vector<Start>& starts, const std::vector<int>& piece) {
    using Entry = std::pair<double, int>;
    for (const int t : reached) distance[t] = kFar;
    reached.clear();
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    const auto reach = [&](int t, double d, char m) {
      if (distance[t] == kFar) reached.push_back(t);
      distance[t] = d;
      mark[t] = m;
      queue.emplace(d, t);
    };
    for (const Start& s : starts)
      if (distance[s.triangle] == kFar) reach(s.triangle, 0, s.mark);
    for (std::size_t steps = 0; !queue.empty(); ++steps) {
      if (steps % 4096 == 0) throwIfCancelled();
      const auto [d, t] = queue.top();
      queue.pop();
      if (d > distance[t]) continue;
      for (std::size_t i = start_[t]; i < start_[t + 1]; ++i) {
        const int o = to_[i];
        const double there = d + norm(centroids_[o] - centroids_[t]);
        if (piece[o] == piece[t] && there < distance[o]) reach(o, there, mark[t]);
      }
    }
  }

  // Of the last spread.
  std::vector<int> reached;
  std::vector<double> distance;
  std::vector<char> mark;

 private:
  std::vector<std::size_t> start_;
  std::vector<int> to_;
  Points centroids_;
};

// Divides charts until no piece meets itself along a seam.
class Division {
 public:
  Division(const Mesh& mesh, const UvCharts& charts)
      : charts_(charts), graph_(mesh), piece(charts.chart), count(charts.count) {}

  void run() {
    bool divided = true;
    while (divided) {
      divided = false;
      std::vector<std::vector<const UvSeam*>> own(static_cast<std::size_t>(count));
      for (const UvSeam& s : charts_.seams)
        if (piece[s.triangle] == piece[s.other] && s.triangle != s.other)
          own[static_cast<std::size_t>(piece[s.triangle])].push_back(&s);
      for (const auto& seams : own) {
        if (seams.empty()) continue;
        divide(seams);
        divided = true;
      }
    }
  }

 private:
  // Which side of each seam is which is told by the distance from one side of
  // the first.
  void divide(const std::vector<const UvSeam*>& seams) {
    graph_.spread({{seams[0]->triangle, 0}}, piece);
    std::vector<ChartGraph::Start> starts{{seams[0]->triangle, 0}, {seams[0]->other, 1}};
    for (const UvSeam* s : seams) {
      const bool nearer = graph_.distance[s->triangle] <= graph_.distance[s->other];
      starts.push_back({nearer ? s->triangle : s->other, 0});
      starts.push_back({nearer ? s->other : s->triangle, 1});
    }
    graph_.spread(starts, piece);
    for (const int t : graph_.reached)
      if (graph_.mark[t]) piece[t] = count;
    ++count;
  }

  const UvCharts& charts_;
  ChartGraph graph_;

 public:
  std::vector<int> piece;
  int count;
};

double lengthOf(const Mesh& mesh, const UvSeam& s) {
  const Triangle& t = mesh.triangles[s.triangle];
  return norm(mesh.vertices[t[(s.corner + 1) % 3]] - mesh.vertices[t[s.corner]]);
}

// Pieces to groups so that seams run between groups: greedy, pieces of most neighbours first (Welsh
// and Powell, "An upper bound for the chromatic number of a graph", 1967); where all groups stand
// around, the one with the shortest seam.
std::vector<int> colouring(const Mesh& mesh, const UvCharts& charts, const std::vector<int>& piece,
                           int pieces, int most) {
  std::vector<std::map<int, double>> joined(static_cast<std::size_t>(pieces));
  for (const UvSeam& s : charts.seams) {
    const int a = piece[s.triangle], b = piece[s.other];
    joined[a][b] += lengthOf(mesh, s);
    joined[b][a] += lengthOf(mesh, s);
  }
  std::vector<int> order(joined.size()), group(joined.size(), -1);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return joined[a].size() > joined[b].size(); });
  for (const int p : order) {
    std::vector<double> shared(static_cast<std::size_t>(most), 0.0);
    for (const auto& [other, length] : joined[p])
      if (group[other] >= 0) shared[group[other]] += length;
    group[p] = static_cast<int>(std::min_element(shared.begin(), shared.end()) - shared.begin());
  }
  return group;
}

}  // namespace

UvCharts uvCharts(const Mesh& mesh) {
  validate(mesh);
  if (mesh.uvTriangles.empty())
    throw DataError(mesh.name +
                    ": has no texture coordinates; unwrap it first "
                    "and save it with its UVs");
  UvCharts out;
  const std::size_t count = mesh.triangles.size();
  DisjointSets sets(count);
  forEachUvPair(
      mesh,
      [&](const EdgeUse& a, const EdgeUse& b, bool agree) {
        if (agree)
          sets.unite(a.triangle, b.triangle);
        else
          out.seams.push_back({a.triangle, a.corner, b.triangle, b.corner});
      },
      &out.edgeLength);
  throwIfCancelled();
  out.chart.assign(count, -1);
  std::vector<int> number(count, -1);
  for (std::size_t t = 0; t < count; ++t) {
    if (!hasUv(mesh, static_cast<int>(t))) continue;
    int& n = number[sets.find(static_cast<int>(t))];
    if (n < 0) n = out.count++;
    out.chart[t] = n;
  }
  for (const UvSeam& s : out.seams) out.seamLength += lengthOf(mesh, s);
  return out;
}

UvGroups uvGroups(const Mesh& mesh, const UvCharts& charts, const UvGroupSettings& settings) {
  const int most = settings.most;
  requireNumber("UV groups", most, {kFewestGroups, kMostGroups});
  Division division(mesh, charts);
  division.run();
  UvGroups out;
  out.pieces = division.count;
  out.group = std::move(division.piece);
  if (out.pieces > most) {
    const std::vector<int> group = colouring(mesh, charts, out.group, out.pieces, most);
    for (int& g : out.group)
      if (g >= 0) g = group[g];
    out.count = 1 + *std::max_element(group.begin(), group.end());
  } else {
    out.count = out.pieces;
  }
  for (const UvSeam& s : charts.seams)
    if (out.group[s.triangle] == out.group[s.other]) out.unresolvedLength += lengthOf(mesh, s);
  return out;
}

}  // namespace innermap
