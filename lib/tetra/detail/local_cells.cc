#include "tetra/detail/local_cells.h"

#include <iterator>
#include <limits>

namespace innermap {
namespace {

// Of the source's tetrahedra: what maps through the mesh is to stay well-defined both ways.
constexpr double kLeastSource = 0.02;
constexpr std::size_t kLongestRing = 8;
constexpr double kNever = -std::numeric_limits<double>::infinity();

bool has(const Tetrahedron& t, int v) { return std::find(t.begin(), t.end(), v) != t.end(); }

// kNever where the source forbids it.
double qualityOf(const LocalCells& cells, const Tetrahedron& t) {
  if (!(leastSine(cells.source, t) >= kLeastSource)) return kNever;
  return leastSine(cells.at, t);
}

// The other two corners, so that (a, b, first, second) is oriented as the tetrahedron is.
std::array<int, 2> othersOf(const Tetrahedron& t, int a, int b) {
  const auto find = [&](int v) { return std::find(t.begin(), t.end(), v) - t.begin(); };
  const std::ptrdiff_t i = find(a), j = find(b);
  std::array<int, 2> others{};
  int count = 0;
  for (int k = 0; k < 4; ++k)
    if (k != i && k != j) others[count++] = k;
  // Parity of (i, j, others).
  const std::array<std::ptrdiff_t, 4> order{i, j, others[0], others[1]};
  int inversions = 0;
  for (int x = 0; x < 4; ++x)
    for (int y = x + 1; y < 4; ++y) inversions += order[x] > order[y];
  if (inversions % 2) std::swap(others[0], others[1]);
  return {t[others[0]], t[others[1]]};
}

// The vertices around the edge in order, if they close a ring.
std::vector<int> ringOf(const LocalCells& cells, int a, int b, std::vector<int>& tets) {
  std::vector<std::array<int, 2>> links;
  for (const int t : cells.star[cells.moving[a] ? a : b])
    if (has(cells.tets[t], a) && has(cells.tets[t], b)) {
      tets.push_back(t);
      links.push_back(othersOf(cells.tets[t], a, b));
    }
  if (links.size() < 3 || links.size() > kLongestRing) return {};
  std::vector<int> ring{links[0][0]};
  int next = links[0][1];
  while (ring.size() < links.size() && next != ring[0]) {
    ring.push_back(next);
    const auto link = std::find_if(links.begin(), links.end(),
                                   [&](const auto& l) { return l[0] == ring.back(); });
    if (link == links.end()) return {};
    next = (*link)[1];
  }
  if (ring.size() != links.size() || next != ring[0]) return {};
  return ring;
}

class Triangulation {
 public:
  Triangulation(const LocalCells& cells, int a, int b, const std::vector<int>& ring)
      : cells_(cells), a_(a), b_(b), ring_(ring) {
    const std::size_t n = ring.size();
    for (std::size_t length = 2; length < n; ++length)
      for (std::size_t i = 0; i + length < n; ++i) {
        const std::size_t k = i + length;
        double& best = best_[i][k] = kNever;
        for (std::size_t j = i + 1; j < k; ++j) {
          double worst = 1;
          if (j > i + 1) worst = std::min(worst, best_[i][j]);
          if (k > j + 1) worst = std::min(worst, best_[j][k]);
          if (!(worst > best)) continue;
          for (const Tetrahedron& t : pair(i, j, k)) worst = std::min(worst, qualityOf(cells_, t));
          if (worst > best) {
            best = worst;
            choice_[i][k] = j;
          }
        }
      }
  }

  double worst() const { return best_[0][ring_.size() - 1]; }

  void collect(std::vector<Tetrahedron>& to) const { collect(0, ring_.size() - 1, to); }

 private:
  std::array<Tetrahedron, 2> pair(std::size_t i, std::size_t j, std::size_t k) const {
    return {{{a_, ring_[i], ring_[j], ring_[k]}, {b_, ring_[i], ring_[k], ring_[j]}}};
  }

  void collect(std::size_t i, std::size_t k, std::vector<Tetrahedron>& to) const {
    if (k < i + 2) return;
    const std::size_t j = choice_[i][k];
    for (const Tetrahedron& t : pair(i, j, k)) to.push_back(t);
    collect(i, j, to);
    collect(j, k, to);
  }

  const LocalCells& cells_;
  int a_, b_;
  const std::vector<int>& ring_;
  std::array<std::array<double, kLongestRing>, kLongestRing> best_{};
  std::array<std::array<std::size_t, kLongestRing>, kLongestRing> choice_{};
};

double worstOf(const LocalCells& cells, const std::vector<int>& tets) {
  double worst = 1;
  for (const int t : tets) worst = std::min(worst, cells.quality(t));
  return worst;
}

}  // namespace

Change removeEdge(const LocalCells& cells, int a, int b) {
  Change change;
  if (!cells.moving[a] && !cells.moving[b]) return change;
  const std::vector<int> ring = ringOf(cells, a, b, change.removed);
  if (ring.empty()) return change;
  change.before = worstOf(cells, change.removed);
  const Triangulation filled(cells, a, b, ring);
  if (!(filled.worst() > change.before)) return change;
  change.after = filled.worst();
  filled.collect(change.added);
  return change;
}

Change removeFace(const LocalCells& cells, int tet, int corner) {
  Change change;
  const Tetrahedron& t = cells.tets[tet];
  std::array<int, 3> face{};
  for (int k = 0, n = 0; k < 4; ++k)
    if (k != corner) face[n++] = t[k];
  int other = -1;
  for (const int s : cells.star[face[0]])
    if (s != tet && has(cells.tets[s], face[1]) && has(cells.tets[s], face[2])) other = s;
  if (other < 0) return change;
  const int b = *std::find_if(cells.tets[other].begin(), cells.tets[other].end(), [&](int v) {
    return std::find(face.begin(), face.end(), v) == face.end();
  });
  change.removed = {tet, other};
  change.before = worstOf(cells, change.removed);
  change.after = 1;
  for (int k = 0; k < 3; ++k) {
    // The tetrahedron with its corner k of the face drawn to b is oriented as it is.
    Tetrahedron made = t;
    std::replace(made.begin(), made.end(), face[k], b);
    change.added.push_back(made);
    change.after = std::min(change.after, qualityOf(cells, made));
  }
  return change;
}

Change collapseEdge(const LocalCells& cells, int from, int to) {
  Change change;
  if (!cells.moving[from] || cells.onBoundary(from)) return change;
  change.removed = cells.star[from];
  change.before = worstOf(cells, change.removed);
  change.after = 1;
  for (const int t : change.removed) {
    if (has(cells.tets[t], to)) continue;
    Tetrahedron made = cells.tets[t];
    std::replace(made.begin(), made.end(), from, to);
    change.added.push_back(made);
    change.after = std::min(change.after, qualityOf(cells, made));
    if (!(change.after > change.before)) return change;
  }
  return change;
}

Change collapseBoundary(const LocalCells& cells, int from, int to) {
  Change change;
  if (!cells.moving[from] || !cells.moving[to]) return change;
  // Neighbours of both are around their edge, or a loop of the boundary would be pinched off.
  const auto neighboursOf = [&](int v) {
    std::vector<int> out;
    for (const int t : cells.star[v])
      for (const int w : cells.tets[t])
        if (w != from && w != to) out.push_back(w);
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  };
  const std::vector<int> ofFrom = neighboursOf(from), ofTo = neighboursOf(to);
  std::vector<int> common, around;
  std::set_intersection(ofFrom.begin(), ofFrom.end(), ofTo.begin(), ofTo.end(),
                        std::back_inserter(common));
  for (const int t : cells.star[from])
    if (has(cells.tets[t], to))
      for (const int w : cells.tets[t])
        if (w != from && w != to) around.push_back(w);
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  if (common != around) return change;
  change.removed = cells.star[from];
  double worst = 1;
  for (const int t : change.removed) {
    if (has(cells.tets[t], to)) continue;
    Tetrahedron made = cells.tets[t];
    std::replace(made.begin(), made.end(), from, to);
    change.added.push_back(made);
    worst = std::min(worst, qualityOf(cells, made));
  }
  change.after = change.added.empty() ? -1 : std::max(-1.0, worst);
  return change;
}

std::vector<int> apply(LocalCells& cells, const Change& change) {
  const auto centreOf = [&](const Tetrahedron& t) {
    const Points& at = cells.source;
    return 0.25 * (at[t[0]] + at[t[1]] + at[t[2]] + at[t[3]]);
  };
  const auto originOf = [&](const Tetrahedron& made) {
    const Vec3 centre = centreOf(made);
    const int nearest =
        *std::min_element(change.removed.begin(), change.removed.end(), [&](int a, int b) {
          return squaredNorm(centreOf(cells.tets[a]) - centre) <
                 squaredNorm(centreOf(cells.tets[b]) - centre);
        });
    return cells.origin[nearest];
  };
  for (const int t : change.removed) cells.remove(t);
  std::vector<int> added;
  for (const Tetrahedron& t : change.added) added.push_back(cells.add(t, originOf(t)));
  return added;
}

}  // namespace innermap
