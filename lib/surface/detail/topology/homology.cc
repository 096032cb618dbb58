#include "surface/detail/topology/homology.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/disjoint_sets.h"
#include "innermap/core/run.h"
#include "surface/detail/topology/edge_distance.h"

namespace innermap {
namespace {

// Shortest paths from vertex 0 along edges: the half-edge by which each vertex is reached.
struct PathTree {
  std::vector<int> reachedBy;  // #V; -1 at the root
  std::vector<double> distance;
};

PathTree shortestPaths(const ClosedSurface& surface, int root) {
  PathTree tree;
  tree.distance = EdgeDistance(surface)({root}, &tree.reachedBy);
  return tree;
}

// The path by `reachedBy` from the root to v.
std::vector<int> pathFromRoot(const std::vector<int>& reachedBy, const HalfEdges& edges, int v) {
  std::vector<int> path;
  for (; reachedBy[v] >= 0; v = edges.tail(reachedBy[v])) path.push_back(reachedBy[v]);
  std::reverse(path.begin(), path.end());
  return path;
}

// h and the way back through the tree from its head to its tail, which meet where they first can.
Loop treeLoop(const std::vector<int>& reachedBy, const HalfEdges& edges, int h) {
  const std::vector<int> to = pathFromRoot(reachedBy, edges, edges.tail(h));
  const std::vector<int> back = pathFromRoot(reachedBy, edges, edges.head(h));
  std::size_t common = 0;
  while (common < to.size() && common < back.size() && to[common] == back[common]) ++common;
  Loop loop(to.begin() + static_cast<std::ptrdiff_t>(common), to.end());
  loop.push_back(h);
  for (std::size_t i = back.size(); i-- > common;) loop.push_back(edges.opposite(back[i]));
  return loop;
}

struct Cotree {
  std::vector<int> chords;   // a half-edge of each edge in neither tree
  std::vector<int> entered;  // for each triangle, the half-edge of its parent that leads to it
  std::vector<int> depth;
};

Cotree cotreeOf(const HalfEdges& edges, const PathTree& tree, const Points& vertices) {
  std::vector<char> inTree(edges.size(), 0);
  for (const int h : tree.reachedBy)
    if (h >= 0) inTree[h] = inTree[edges.opposite(h)] = 1;
  std::vector<std::pair<double, int>> rest;
  for (int h = 0; h < edges.size(); ++h) {
    const int u = edges.tail(h), v = edges.head(h);
    if (!inTree[h] && h < edges.opposite(h))
      rest.push_back({tree.distance[u] + tree.distance[v] + norm(vertices[u] - vertices[v]), h});
  }
  // The longest loops are closed by the cotree; ties by number.
  std::sort(rest.begin(), rest.end(), [](const auto& a, const auto& b) {
    return a.first > b.first || (a.first == b.first && a.second < b.second);
  });
  const int triangles = edges.size() / 3;
  DisjointSets sets(static_cast<std::size_t>(triangles));
  Cotree out;
  std::vector<char> inCotree(edges.size(), 0);
  for (const auto& [length, h] : rest) {
    if (sets.unite(h / 3, edges.opposite(h) / 3))
      inCotree[h] = inCotree[edges.opposite(h)] = 1;
    else
      out.chords.push_back(h);
  }
  std::reverse(out.chords.begin(), out.chords.end());
  out.entered.assign(triangles, -1);
  out.depth.assign(triangles, 0);
  std::vector<int> stack{0};
  while (!stack.empty()) {
    const int t = stack.back();
    stack.pop_back();
    for (int h = 3 * t; h < 3 * t + 3; ++h) {
      const int other = edges.opposite(h) / 3;
      if (!inCotree[h] || other == 0 || out.entered[other] >= 0 ||
          (out.entered[t] >= 0 && h == edges.opposite(out.entered[t])))
        continue;
      out.entered[other] = h;
      out.depth[other] = out.depth[t] + 1;
      stack.push_back(other);
    }
  }
  return out;
}

// The half-edges out of which the cycle of triangles runs that crosses `chord` from left to right
// and returns through the cotree.
std::vector<int> dualCycle(const Cotree& cotree, const HalfEdges& edges, int chord) {
  std::vector<int> cycle{chord};
  int from = edges.opposite(chord) / 3, to = chord / 3;
  std::vector<int> last;
  while (from != to) {
    if (cotree.depth[from] >= cotree.depth[to]) {
      cycle.push_back(edges.opposite(cotree.entered[from]));
      from = cotree.entered[from] / 3;
    } else {
      last.push_back(cotree.entered[to]);
      to = cotree.entered[to] / 3;
    }
  }
  cycle.insert(cycle.end(), last.rbegin(), last.rend());
  return cycle;
}

// Of each triangle that forms use: a form's values on its first two half-edges.
struct FormUse {
  int triangle, form;
  std::array<int, 2> value;
};

std::vector<FormUse> formUses(const HomologyBasis& basis, const HalfEdges& edges) {
  std::vector<std::array<int, 4>> values;  // triangle, form, corner, value
  for (std::size_t i = 0; i < basis.size(); ++i) {
    for (const int h : basis.forms[i]) {
      const int o = edges.opposite(h);
      values.push_back({h / 3, static_cast<int>(i), h % 3, 1});
      values.push_back({o / 3, static_cast<int>(i), o % 3, -1});
    }
  }
  std::sort(values.begin(), values.end());
  std::vector<FormUse> uses;
  for (const auto& [triangle, form, corner, value] : values) {
    if (uses.empty() || uses.back().triangle != triangle || uses.back().form != form)
      uses.push_back({triangle, form, {0, 0}});
    if (corner < 2) uses.back().value[static_cast<std::size_t>(corner)] += value;
  }
  return uses;
}

// The forms' wedge products integrated over the surface, inverted and transposed.
IntegerMatrix crossingsOf(const HomologyBasis& basis, const HalfEdges& edges) {
  const auto n = static_cast<Eigen::Index>(basis.size());
  Eigen::MatrixXd wedge = Eigen::MatrixXd::Zero(n, n);
  const std::vector<FormUse> uses = formUses(basis, edges);
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    while (end < uses.size() && uses[end].triangle == uses[begin].triangle) ++end;
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t j = begin; j < end; ++j) {
        const auto &a = uses[i].value, &b = uses[j].value;
        wedge(uses[i].form, uses[j].form) += 0.5 * (a[0] * b[1] - a[1] * b[0]);
      }
    }
  }
  const Eigen::MatrixXd inverse = wedge.inverse().transpose();
  IntegerMatrix out(basis.size(), Integers(basis.size(), 0));
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) out[i][j] = std::llround(inverse(i, j));
  return out;
}

}  // namespace

HomologyBasis homologyBasis(const ClosedSurface& surface, const HalfEdges& edges) {
  throwIfCancelled();
  const PathTree tree = shortestPaths(surface, 0);
  throwIfCancelled();
  const Cotree cotree = cotreeOf(edges, tree, surface.vertices);
  HomologyBasis basis;
  for (const int h : cotree.chords) {
    throwIfCancelled();
    basis.loops.push_back(treeLoop(tree.reachedBy, edges, h));
    basis.forms.push_back(dualCycle(cotree, edges, h));
  }
  basis.crossings = crossingsOf(basis, edges);
  return basis;
}

std::vector<int> combinedForm(const HomologyBasis& basis, const Integers& coefficients,
                              const HalfEdges& edges) {
  std::vector<int> form(edges.size(), 0);
  for (std::size_t i = 0; i < basis.size(); ++i) {
    for (const int h : basis.forms[i]) {
      form[h] += static_cast<int>(coefficients[i]);
      form[edges.opposite(h)] -= static_cast<int>(coefficients[i]);
    }
  }
  return form;
}

long long crossingNumber(const HomologyBasis& basis, const Integers& a, const Integers& b) {
  long long sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) sum += a[i] * basis.crossings[i][j] * b[j];
  return sum;
}

IntegerMatrix leftKernel(const IntegerMatrix& m) {
  const std::size_t n = m.size(), columns = m.empty() ? 0 : m[0].size();
  IntegerMatrix rows = m, combination(n, Integers(n, 0));
  for (std::size_t i = 0; i < n; ++i) combination[i][i] = 1;
  // Euclid's algorithm on the rows, column by column, with the least entry as divisor.
  std::size_t done = 0;
  for (std::size_t c = 0; c < columns && done < n; ++c) {
    for (;;) {
      std::size_t least = n, others = 0;
      for (std::size_t i = done; i < n; ++i) {
        if (rows[i][c] == 0) continue;
        ++others;
        if (least == n || std::abs(rows[i][c]) < std::abs(rows[least][c])) least = i;
      }
      if (others == 0) break;
      std::swap(rows[done], rows[least]);
      std::swap(combination[done], combination[least]);
      if (others == 1) {
        ++done;
        break;
      }
      for (std::size_t i = done + 1; i < n; ++i) {
        const long long q = rows[i][c] / rows[done][c];
        for (std::size_t k = 0; k < columns; ++k) rows[i][k] -= q * rows[done][k];
        for (std::size_t k = 0; k < n; ++k) combination[i][k] -= q * combination[done][k];
      }
    }
  }
  return {combination.begin() + static_cast<std::ptrdiff_t>(done), combination.end()};
}

}  // namespace innermap
