#include "surface/detail/refining/progressive_mesh.h"

#include <algorithm>

namespace innermap {
namespace {

int cornerOf(const Triangle& t, int v) { return t[0] == v ? 0 : t[1] == v ? 1 : 2; }

bool contains(const Triangle& t, int v) { return t[0] == v || t[1] == v || t[2] == v; }

}  // namespace

ProgressiveMesh::ProgressiveMesh(std::size_t vertices, const std::vector<Triangle>& triangles,
                                 const std::vector<CornerShifts>& shift)
    : triangles_(triangles),
      shift_(shift),
      alive_(triangles.size(), 1),
      present_(vertices, 1),
      around_(vertices),
      vertexCount_(vertices) {
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const int v : triangles[t]) around_[v].push_back(static_cast<int>(t));
}

void ProgressiveMesh::ring(int v, Ring& out) const {
  const std::vector<int>& star = around_[v];
  struct Side {
    RingVertex from, to;
  };
  thread_local std::vector<Side> sides;
  sides.clear();
  for (const int t : star) {
    const int k = cornerOf(triangles_[t], v), i = (k + 1) % 3, j = (k + 2) % 3;
    const Shift own = shift(t, k);
    sides.push_back({{triangles_[t][i], shift(t, i) - own}, {triangles_[t][j], shift(t, j) - own}});
  }
  out.clear();
  const std::size_t n = sides.size();
  if (n > 24) {
    std::sort(sides.begin(), sides.end(),
              [](const Side& a, const Side& b) { return a.from.vertex < b.from.vertex; });
    std::size_t at = 0;
    for (std::size_t i = 0; i < n; ++i) {
      out.push_back(sides[at].from);
      const int next = sides[at].to.vertex;
      at = static_cast<std::size_t>(
          std::lower_bound(sides.begin(), sides.end(), next,
                           [](const Side& a, int x) { return a.from.vertex < x; }) -
          sides.begin());
      if (at >= n) break;
    }
    return;
  }
  std::size_t at = 0;
  for (std::size_t i = 0; i < n; ++i) {
    out.push_back(sides[at].from);
    const int next = sides[at].to.vertex;
    for (std::size_t j = 0; j < n; ++j)
      if (sides[j].from.vertex == next) {
        at = j;
        break;
      }
  }
}

bool ProgressiveMesh::collapsible(const Ring& ring, std::size_t w) const {
  if (vertexCount_ <= 4) return false;
  const std::size_t n = ring.size();
  const int before = ring[(w + n - 1) % n].vertex, after = ring[(w + 1) % n].vertex;
  if (around_[before].size() <= 3 || around_[after].size() <= 3) return false;
  // Link condition: of v's neighbours only the two beside the edge are w's neighbours too.
  const int into = ring[w].vertex;
  std::size_t common = 0;
  for (const int t : around_[into])
    for (const int x : triangles_[t]) {
      if (x == into) continue;
      for (const RingVertex& r : ring)
        if (r.vertex == x) ++common;
    }
  return common == 4;  // each is met in two triangles of w
}

void ProgressiveMesh::erase(int v, int t) {
  std::vector<int>& star = around_[v];
  star.erase(std::find(star.begin(), star.end(), t));
}

void ProgressiveMesh::collapse(int v, const RingVertex& w) {
  Split record{v, w.vertex, {-1, -1}, w.shift, moved_.size()};
  int dead = 0;
  for (const int t : around_[v]) {
    if (contains(triangles_[t], w.vertex)) {
      record.dead[dead++] = t;
      alive_[t] = 0;
      for (const int x : triangles_[t])
        if (x != v) erase(x, t);
      continue;
    }
    moved_.push_back(t);
    const int k = cornerOf(triangles_[t], v);
    triangles_[t][k] = w.vertex;
    if (!shift_.empty()) shift_[t][k] = shift_[t][k] + w.shift;
    around_[w.vertex].push_back(t);
  }
  present_[v] = 0;
  --vertexCount_;
  splits_.push_back(record);
}

void ProgressiveMesh::nextStar(std::vector<int>& vertices) const {
  const Split& record = splits_.back();
  vertices = {record.vertex};
  const auto add = [&](int t) {
    vertices.insert(vertices.end(), triangles_[t].begin(), triangles_[t].end());
  };
  std::for_each(moved_.begin() + static_cast<std::ptrdiff_t>(record.moved), moved_.end(), add);
  for (const int t : record.dead) add(t);
}

int ProgressiveMesh::split() {
  const Split record = splits_.back();
  splits_.pop_back();
  const int v = record.vertex;
  for (std::size_t i = record.moved; i < moved_.size(); ++i) {
    const int t = moved_[i], k = cornerOf(triangles_[t], record.into);
    triangles_[t][k] = v;
    if (!shift_.empty()) shift_[t][k] = shift_[t][k] - record.shift;
    erase(record.into, t);
  }
  moved_.resize(record.moved);
  for (const int t : record.dead) {
    alive_[t] = 1;
    for (const int x : triangles_[t])
      if (x != v) around_[x].push_back(t);
  }
  present_[v] = 1;
  ++vertexCount_;
  return v;
}

}  // namespace innermap
