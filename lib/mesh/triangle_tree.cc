#include "mesh/triangle_tree.h"

#include <array>

#include "innermap/core/run.h"
#include "mesh/detail/local_triangles.h"

namespace innermap {
namespace {

constexpr int kPartTriangles = 128;  // of each of the two nodes of a part, at most

struct Candidate {
  double v = 0, w = 0;  // barycentric coordinates of b and c
  Vec3 position;
  double squared = std::numeric_limits<double>::infinity();
};

Candidate candidate(const Vec3& p, const Vec3& position, double v, double w) {
  return {v, w, position, squaredNorm(p - position)};
}

// Parameter of the point of segment a, a + d closest to p; 0 for a segment without length.
double closestOnSegment(const Vec3& p, const Vec3& a, const Vec3& d) {
  const double length2 = squaredNorm(d);
  const double t = length2 > 0 ? dot(p - a, d) / length2 : 0;
  return t > 0 ? std::min(t, 1.0) : 0;
}

Candidate closestOnEdges(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const double ab = closestOnSegment(p, a, b - a);
  const double ac = closestOnSegment(p, a, c - a);
  const double bc = closestOnSegment(p, b, c - b);
  Candidate best = candidate(p, a + ab * (b - a), ab, 0);
  const Candidate second = candidate(p, a + ac * (c - a), 0, ac);
  const Candidate third = candidate(p, b + bc * (c - b), 1 - bc, bc);
  if (second.squared < best.squared) best = second;
  if (third.squared < best.squared) best = third;
  return best;
}

// Ericson, Real-Time Collision Detection, 5.1.5: by the Voronoi region that p is in. Vertices are
// returned as they are, so that triangles around a vertex give equal distances.
Candidate closestOnTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return candidate(p, a, 0, 0);
  const Vec3 bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return candidate(p, b, 1, 0);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) {
    const double v = d1 / (d1 - d3);
    return candidate(p, a + v * ab, v, 0);
  }
  const Vec3 cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return candidate(p, c, 0, 1);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) {
    const double w = d2 / (d2 - d6);
    return candidate(p, a + w * ac, 0, w);
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6 && (d4 - d3) + (d5 - d6) > 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return candidate(p, b + w * (c - b), 1 - w, w);
  }
  const double sum = va + vb + vc;
  if (!(sum > 0)) return closestOnEdges(p, a, b, c);
  const double v = std::clamp(vb / sum, 0.0, 1.0), w = std::clamp(vc / sum, 0.0, 1.0 - v);
  return candidate(p, a + v * ab + w * ac, v, w);
}

// Where the height is below about a millionth of the length, rounding can send a point into the
// wrong Voronoi region; there the edges are tried too.
bool isSliver(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, bc = c - b;
  const double length2 = std::max({squaredNorm(ab), squaredNorm(ac), squaredNorm(bc)});
  return squaredNorm(cross(ab, ac)) <= 1e-12 * length2 * length2;
}

Candidate closestOnTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c,
                            bool sliver) {
  const Candidate found = closestOnTriangle(p, a, b, c);
  if (!sliver) return found;
  const Candidate edge = closestOnEdges(p, a, b, c);
  return found.squared <= edge.squared ? found : edge;
}

}  // namespace

ClosestPoint closestOnTriangle(const Vec3& p, const std::array<Vec3, 3>& corners) {
  const auto& [a, b, c] = corners;
  const Candidate found = closestOnTriangle(p, a, b, c, isSliver(a, b, c));
  return {{0, {1 - found.v - found.w, found.v, found.w}}, found.position, std::sqrt(found.squared)};
}

struct TriangleTree::Implementation {
  const std::shared_ptr<const LocalTriangles> local;
  const LocalFrame& frame = local->frame;
  const Bvh& bvh = local->bvh;
  const std::vector<Box3>& boxes = local->boxes;
  std::vector<char> slivers;  // in the order of the leaves

  Implementation(const Points& vertices, const std::vector<Triangle>& given)
      : local(std::make_shared<const LocalTriangles>(vertices, given)) {
    slivers.reserve(local->corners.size());
    for (const auto& [a, b, c] : local->corners) slivers.push_back(isSliver(a, b, c));
  }

  void search(int i, const Vec3& p, Candidate& best, int& bestIndex) const {
    const auto& [a, b, c] = local->corners[i];
    const Candidate found = closestOnTriangle(p, a, b, c, slivers[i] != 0);
    if (found.squared < best.squared ||
        (found.squared == best.squared && bestIndex >= 0 && local->index[i] < bestIndex)) {
      best = found;
      bestIndex = local->index[i];
    }
  }

  ClosestPoint pointOf(const Candidate& best, int bestIndex) const {
    ClosestPoint result;
    result.address.triangle = bestIndex;
    if (bestIndex < 0) return result;
    result.address.barycentric = {1 - best.v - best.w, best.v, best.w};
    result.position = frame.toWorld(best.position);
    result.distance = std::sqrt(best.squared) * frame.inverse;
    return result;
  }

  double squaredDistance(int i, const Vec3& p) const {
    const Box3& box = boxes[i];
    double sum = 0;
    for (int a = 0; a < 3; ++a) {
      const double d = std::max({box.lower[a] - p[a], 0.0, p[a] - box.upper[a]});
      sum += d * d;
    }
    return sum;
  }

  double squaredReach(double within) const {
    return (within * frame.scale) * (within * frame.scale);
  }

  void collect(const Vec3& world, double within, Part& part) const {
    part.clear();
    if (bvh.nodes.empty()) return;
    const Vec3 p = frame.toLocal(world);
    const double reach = squaredReach(within);
    std::array<int, Bvh::kMaxDepth + 2> stack;
    int top = 0;
    stack[top++] = 0;
    while (top > 0) {
      const Bvh::Node& node = bvh.nodes[stack[--top]];
      if (!(node.squaredDistance(p) <= reach)) continue;
      if (!node.leaf()) {
        stack[top++] = node.first + 1;
        stack[top++] = node.first;
        continue;
      }
      for (int i = node.first; i < node.first + node.count; ++i)
        if (squaredDistance(i, p) <= reach) part.push_back(i);
    }
  }

  void collect(const Vec3& world, double within, const Part& from, Part& part) const {
    part.clear();
    const Vec3 p = frame.toLocal(world);
    const double reach = squaredReach(within);
    for (const int i : from)
      if (squaredDistance(i, p) <= reach) part.push_back(i);
  }

  ClosestPoint closest(const Vec3& world, double within, const Part& part) const {
    const Vec3 p = frame.toLocal(world);
    Candidate best;
    best.squared = squaredReach(within);
    int bestIndex = -1;
    for (const int i : part)
      if (squaredDistance(i, p) <= best.squared) search(i, p, best, bestIndex);
    return pointOf(best, bestIndex);
  }

  // first: any triangle that is nearer than `within` will do.
  ClosestPoint closest(const Vec3& world, double within, bool first) const {
    Candidate best;
    int bestIndex = -1;
    if (bvh.nodes.empty() || !isFinite(world) || !(within > 0)) return pointOf(best, bestIndex);
    const Vec3 p = frame.toLocal(world);
    best.squared = squaredReach(within);

    struct Entry {
      int node;
      double squared;
    };
    std::array<Entry, Bvh::kMaxDepth + 2> stack;
    int top = 0;
    stack[top++] = {0, bvh.nodes[0].squaredDistance(p)};
    while (top > 0) {
      const Entry entry = stack[--top];
      // Equal distances are followed: a lower index may win.
      if (!(entry.squared <= best.squared)) continue;
      const Bvh::Node& node = bvh.nodes[entry.node];
      if (node.leaf()) {
        for (int i = node.first; i < node.first + node.count; ++i)
          if (squaredDistance(i, p) <= best.squared) search(i, p, best, bestIndex);
        if (first && bestIndex >= 0) break;
        continue;
      }
      Entry near{node.first, bvh.nodes[node.first].squaredDistance(p)};
      Entry far{node.first + 1, bvh.nodes[node.first + 1].squaredDistance(p)};
      if (far.squared < near.squared) std::swap(near, far);
      if (far.squared <= best.squared) stack[top++] = far;
      if (near.squared <= best.squared) stack[top++] = near;
    }
    return pointOf(best, bestIndex);
  }

  template <typename Visit>
  void visitLeaves(const Bvh::Node& x, const Bvh::Node& y, const Visit& visit) const {
    const bool same = &x == &y;
    for (int i = x.first; i < x.first + x.count; ++i) {
      for (int j = same ? i + 1 : y.first; j < y.first + y.count; ++j) {
        bool overlap = true;
        for (int a = 0; a < 3; ++a) {
          overlap = overlap && boxes[i].lower[a] <= boxes[j].upper[a] &&
                    boxes[j].lower[a] <= boxes[i].upper[a];
        }
        if (!overlap) continue;
        const int s = local->index[i], t = local->index[j];
        visit(std::min(s, t), std::max(s, t));
      }
    }
  }

  using NodePair = std::array<int, 2>;

  // Pairs of nodes at or below those two whose boxes overlap, down to where isEnd(node) holds of
  // both; it must hold of leaves.
  template <typename IsEnd, typename Visit>
  void descend(const NodePair& from, const IsEnd& isEnd, const Visit& visit) const {
    std::vector<NodePair> stack{from};
    while (!stack.empty()) {
      const NodePair pair = stack.back();
      stack.pop_back();
      const auto [i, j] = pair;
      const Bvh::Node &x = bvh.nodes[i], &y = bvh.nodes[j];
      if (i != j && !x.overlaps(y)) continue;
      if (isEnd(i) && isEnd(j)) {
        visit(pair);
      } else if (i == j) {
        stack.push_back({x.first, x.first + 1});
        stack.push_back({x.first + 1, x.first + 1});
        stack.push_back({x.first, x.first});
      } else if (y.leaf() || (!x.leaf() && i < j)) {
        // Nodes with lower indices stand higher in the tree: descend there.
        stack.push_back({x.first + 1, j});
        stack.push_back({x.first, j});
      } else {
        stack.push_back({i, y.first + 1});
        stack.push_back({i, y.first});
      }
    }
  }

  // Triangles below each node.
  std::vector<int> counts() const {
    std::vector<int> out(bvh.nodes.size());
    for (std::size_t n = out.size(); n-- > 0;) {
      const Bvh::Node& node = bvh.nodes[n];
      out[n] = node.leaf() ? node.count : out[node.first] + out[node.first + 1];
    }
    return out;
  }

  void overlappingPairs(const PairVisitor& visit, const std::function<void()>& next) const {
    if (bvh.nodes.empty()) return;
    const std::vector<int> count = counts();
    std::vector<NodePair> parts;
    const auto look = [&] {
      parallelBlocks(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t part = begin; part < end; ++part)
          descend(
              parts[part], [&](int n) { return bvh.nodes[n].leaf(); },
              [&](const NodePair& leaves) {
                visitLeaves(bvh.nodes[leaves[0]], bvh.nodes[leaves[1]],
                            [&](int i, int j) { visit(part, i, j); });
              });
      });
      next();
      parts.clear();
    };
    descend(
        {0, 0}, [&](int n) { return bvh.nodes[n].leaf() || count[n] <= kPartTriangles; },
        [&](const NodePair& nodes) {
          parts.push_back(nodes);
          if (parts.size() == kParts) look();
        });
    look();
  }
};

TriangleTree::TriangleTree(const Points& vertices, const std::vector<Triangle>& triangles)
    : implementation_(std::make_shared<const Implementation>(vertices, triangles)) {}

ClosestPoint TriangleTree::closest(const Vec3& p, double within) const {
  return implementation_->closest(p, within, false);
}

bool TriangleTree::hasCloser(const Vec3& p, double within) const {
  return implementation_->closest(p, within, true).address.triangle >= 0;
}

void TriangleTree::collect(const Vec3& p, double within, Part& part) const {
  implementation_->collect(p, within, part);
}

void TriangleTree::collect(const Vec3& p, double within, const Part& from, Part& part) const {
  implementation_->collect(p, within, from, part);
}

ClosestPoint TriangleTree::closest(const Vec3& p, double within, const Part& part) const {
  return implementation_->closest(p, within, part);
}

void TriangleTree::overlappingPairs(const PairVisitor& visit,
                                    const std::function<void()>& next) const {
  implementation_->overlappingPairs(visit, next);
}

std::size_t TriangleTree::size() const { return implementation_->local->given; }

std::shared_ptr<const LocalTriangles> TriangleTree::local() const { return implementation_->local; }

}  // namespace innermap
