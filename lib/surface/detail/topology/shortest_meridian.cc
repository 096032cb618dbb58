#include "surface/detail/topology/shortest_meridian.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <queue>
#include <unordered_map>
#include <utility>

#include "innermap/core/run.h"

namespace innermap {
namespace {

// Keeps a source in a fat part of a surface with many small tunnels from walking all of a covering
// surface that grows without end.
constexpr std::size_t kCopies = 40;

// Classes of paths, and the sheet of the covering surface where each ends.
class Sheets {
 public:
  Sheets(const HalfEdges& edges, const HomologyBasis& basis, const IntegerMatrix& bounding)
      : start_(static_cast<std::size_t>(edges.size()) + 1, 0) {
    std::vector<std::array<int, 3>> uses;  // half-edge, form, value
    for (std::size_t i = 0; i < basis.size(); ++i) {
      for (const int h : basis.forms[i]) {
        uses.push_back({h, static_cast<int>(i), 1});
        uses.push_back({edges.opposite(h), static_cast<int>(i), -1});
      }
    }
    std::sort(uses.begin(), uses.end());
    for (const auto& [h, form, value] : uses) {
      ++start_[static_cast<std::size_t>(h) + 1];
      uses_.push_back({form, value});
    }
    for (std::size_t h = 1; h < start_.size(); ++h) start_[h] += start_[h - 1];
    for (const Integers& k : bounding) {
      Integers row(basis.size(), 0);
      for (std::size_t i = 0; i < basis.size(); ++i)
        for (std::size_t j = 0; j < basis.size(); ++j) row[j] += k[i] * basis.crossings[i][j];
      crossed_.push_back(std::move(row));
    }
    number(Integers(basis.size(), 0));
  }

  int after(int path, int h) {
    const auto index = static_cast<std::size_t>(h);
    if (start_[index] == start_[index + 1]) return path;
    Integers sum = classes_[static_cast<std::size_t>(path)];
    for (std::size_t i = start_[index]; i < start_[index + 1]; ++i)
      sum[static_cast<std::size_t>(uses_[i].first)] += uses_[i].second;
    return number(std::move(sum));
  }
  int sheet(int path) const { return sheet_[static_cast<std::size_t>(path)]; }

  Integers difference(int path, int other) const {
    Integers out = classes_[static_cast<std::size_t>(path)];
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] -= classes_[static_cast<std::size_t>(other)][i];
    return out;
  }

 private:
  int number(Integers path) {
    const auto [found, isNew] = numbers_.try_emplace(path, static_cast<int>(classes_.size()));
    if (!isNew) return found->second;
    // Loops of a bounding class, and no others, cross no bounding class.
    Integers crossings;
    for (const Integers& row : crossed_) {
      long long sum = 0;
      for (std::size_t i = 0; i < path.size(); ++i) sum += row[i] * path[i];
      crossings.push_back(sum);
    }
    sheet_.push_back(
        sheets_.try_emplace(std::move(crossings), static_cast<int>(sheets_.size())).first->second);
    classes_.push_back(std::move(path));
    return found->second;
  }

  std::vector<std::size_t> start_;  // of each half-edge in uses_
  std::vector<std::pair<int, int>> uses_;
  IntegerMatrix crossed_, classes_;
  std::vector<int> sheet_;
  std::map<Integers, int> numbers_, sheets_;
};

class MeridianSearch {
 public:
  MeridianSearch(const Points& vertices, const HalfEdges& edges, const HomologyBasis& basis,
                 const MeridianQuery& query)
      : vertices_(vertices),
        edges_(edges),
        query_(query),
        sheets_(edges, basis, query.bounding),
        outgoing_(edges.outgoing(vertices.size())),
        met_(vertices.size(), -1) {
    best_.length = query.longest > 0 ? query.longest : std::numeric_limits<double>::infinity();
  }

  void from(int source) {
    nodes_.clear();
    found_.clear();
    queue_ = {};
    nodes_.push_back({source, 0, -1, -1, 0, false});
    found_[key(source, 0)] = 0;
    queue_.push({0, 0});
    const std::size_t most = kCopies * vertices_.size();
    while (!queue_.empty() && nodes_.size() < most) {
      const auto [distance, u] = queue_.top();
      queue_.pop();
      if (2 * distance >= best_.length) break;
      if (nodes_[u].settled || distance > nodes_[u].distance) continue;
      nodes_[u].settled = true;
      const int first = outgoing_[nodes_[u].vertex];
      int h = first;
      do {
        if (!query_.blocked[edges_.head(h)]) look(u, h);
        h = edges_.counterclockwise(h);
      } while (h != first);
    }
  }

  MeridianLoop take() { return std::move(best_); }

 private:
  struct Node {
    int vertex, path, parent, by;  // class of the path; the node before and the half-edge from it
    double distance;
    bool settled;
  };

  static std::uint64_t key(int vertex, int sheet) {
    return static_cast<std::uint64_t>(sheet) << 32 | static_cast<std::uint32_t>(vertex);
  }

  void look(int u, int h) {
    const int w = edges_.head(h);
    const int path = sheets_.after(nodes_[u].path, h);
    const double distance = nodes_[u].distance + norm(vertices_[w] - vertices_[edges_.tail(h)]);
    const auto [found, isNew] =
        found_.try_emplace(key(w, sheets_.sheet(path)), static_cast<int>(nodes_.size()));
    if (isNew) {
      nodes_.push_back({w, path, u, h, distance, false});
      queue_.push({distance, found->second});
      return;
    }
    Node& node = nodes_[found->second];
    if (!node.settled) {
      if (distance < node.distance) {
        node = {w, path, u, h, distance, false};
        queue_.push({distance, found->second});
      }
    } else if (path != node.path && distance + node.distance < best_.length) {
      close(u, h, found->second, sheets_.difference(path, node.path));
    }
  }

  void close(int u, int h, int w, Integers cycle) {
    if (!isNew(cycle)) return;
    std::vector<int> forth, back;
    for (int n = u; nodes_[n].parent >= 0; n = nodes_[n].parent) forth.push_back(nodes_[n].by);
    for (int n = w; nodes_[n].parent >= 0; n = nodes_[n].parent) back.push_back(nodes_[n].by);
    while (!forth.empty() && !back.empty() && forth.back() == back.back()) {
      forth.pop_back();
      back.pop_back();
    }
    Loop loop(forth.rbegin(), forth.rend());
    loop.push_back(h);
    for (const int b : back) loop.push_back(edges_.opposite(b));
    double length = 0;
    ++round_;
    for (const int e : loop) {
      const int v = edges_.tail(e);
      if (met_[v] == round_) return;  // on another sheet
      met_[v] = round_;
      length += norm(vertices_[edges_.head(e)] - vertices_[v]);
    }
    if (length < best_.length && loop.size() > 2)
      best_ = {std::move(loop), std::move(cycle), length};
  }

  bool isNew(const Integers& cycle) {
    const auto known = new_.find(cycle);
    if (known != new_.end()) return known->second;
    Integers back = cycle;
    for (long long& c : back) c = -c;
    bool isNew = back != cycle;
    if (query_.independent) {
      IntegerMatrix rows = query_.taken;
      rows.push_back(cycle);
      isNew = leftKernel(rows).empty();
    } else {
      for (const Integers& t : query_.taken) isNew = isNew && t != cycle && t != back;
    }
    return new_[cycle] = isNew;
  }

  const Points& vertices_;
  const HalfEdges& edges_;
  const MeridianQuery& query_;
  Sheets sheets_;
  std::vector<int> outgoing_, met_;
  int round_ = 0;
  MeridianLoop best_;
  std::vector<Node> nodes_;
  std::unordered_map<std::uint64_t, int> found_;
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
  std::map<Integers, bool> new_;
};

}  // namespace

MeridianLoop shortestMeridian(const Points& vertices, const HalfEdges& edges,
                              const HomologyBasis& basis, const MeridianQuery& query) {
  MeridianSearch search(vertices, edges, basis, query);
  std::vector<char> source(vertices.size(), 0);
  for (const Loop& loop : basis.loops)
    for (const int h : loop) source[edges.tail(h)] = 1;
  for (int v = 0; v < static_cast<int>(vertices.size()); ++v) {
    if (!source[v] || query.blocked[v]) continue;
    throwIfCancelled();
    search.from(v);
  }
  MeridianLoop found = search.take();
  if (found.loop.empty()) found.length = 0;
  return found;
}

}  // namespace innermap
