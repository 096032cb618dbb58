#include "fit/detail/refined_surface.h"

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace innermap {
namespace {

using Corner = std::array<double, 3>;

Corner between(const Corner& a, const Corner& b, double t) {
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

std::uint64_t keyOf(int a, int b) {
  return (static_cast<std::uint64_t>(std::min(a, b)) << 32) |
         static_cast<std::uint64_t>(std::max(a, b));
}

// The places that are looked at along each edge that is not known.
struct Edges {
  std::vector<std::array<int, 2>> ends;
  std::vector<SurfacePoint> places;  // three an edge
};

// Of triangles with a vertex from firstNew on: all new edges end at one.
Edges unknownEdges(const RefinedSurface& surface, const EdgeImages& known, int firstNew) {
  Edges out;
  std::unordered_set<std::uint64_t> seen;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const Triangle& corners = surface.triangles[t];
    if (*std::max_element(corners.begin(), corners.end()) < firstNew) continue;
    for (int e = 0; e < 3; ++e) {
      int from = e, to = (e + 1) % 3;
      if (corners[from] > corners[to]) std::swap(from, to);
      const std::array<int, 2> ends{corners[from], corners[to]};
      if (known.count(ends) > 0 || !seen.insert(keyOf(ends[0], ends[1])).second) continue;
      const RefinedSurface::Part& part = surface.parts[t];
      out.ends.push_back(ends);
      for (const double along : kAlongEdge)
        out.places.push_back({part.triangle, between(part.corners[from], part.corners[to], along)});
    }
  }
  return out;
}

void lookAt(const Edges& edges, const PlacesToPoints& imagesOf, EdgeImages& known) {
  const Points on = imagesOf(edges.places);
  for (std::size_t i = 0; i < edges.ends.size(); ++i)
    known.emplace(edges.ends[i], std::array<Vec3, 3>{on[3 * i], on[3 * i + 1], on[3 * i + 2]});
}

// The edge of a triangle, named by the corner before it, that is longest on the mesh.
int longestEdge(const RefinedSurface& surface, const Triangle& t) {
  const auto size = [&](int e) {
    const int a = t[e], b = t[(e + 1) % 3];
    return std::make_pair(norm(surface.positions[a] - surface.positions[b]), keyOf(a, b));
  };
  int out = 0;
  for (int e = 1; e < 3; ++e)
    if (size(e) > size(out)) out = e;
  return out;
}

// New vertices, by the edges whose middles they are.
class Middles {
 public:
  bool empty() const { return byEdge_.empty(); }

  // False where it is there already.
  bool add(int a, int b, int vertex) {
    const auto size = static_cast<std::size_t>(std::max(a, b)) + 1;
    if (ends_.size() < size) ends_.resize(std::max(size, 2 * ends_.size()));
    ends_[a] = ends_[b] = true;
    return byEdge_.emplace(keyOf(a, b), vertex).second;
  }

  // -1 of an edge that stays whole.
  int of(int a, int b) const {
    // Of most edges, at less cost.
    if (static_cast<std::size_t>(std::max(a, b)) >= ends_.size() || !ends_[a] || !ends_[b])
      return -1;
    const auto found = byEdge_.find(keyOf(a, b));
    return found == byEdge_.end() ? -1 : found->second;
  }

  int of(const Triangle& t, int e) const { return of(t[e], t[(e + 1) % 3]); }

  bool any(const Triangle& t) const { return of(t, 0) >= 0 || of(t, 1) >= 0 || of(t, 2) >= 0; }

 private:
  std::unordered_map<std::uint64_t, int> byEdge_;
  std::vector<char> ends_;  // whether a vertex is one of such an edge
};

struct Triangulation {
  std::vector<Triangle> triangles;
  std::vector<RefinedSurface::Part> parts;
};

// Cut from the middle of its longest edge to the corner across, and the halves where their other
// edge is split too.
void split(const RefinedSurface& from, std::size_t t, const Middles& middles, Triangulation& to) {
  const Triangle& corners = from.triangles[t];
  const RefinedSurface::Part& part = from.parts[t];
  if (!middles.any(corners)) {
    to.triangles.push_back(corners);
    to.parts.push_back(part);
    return;
  }
  const int a = longestEdge(from, corners), b = (a + 1) % 3, c = (a + 2) % 3;
  struct Point {
    int vertex;
    Corner at;
  };
  const auto add = [&](const Point& p, const Point& q, const Point& r) {
    to.triangles.push_back({p.vertex, q.vertex, r.vertex});
    to.parts.push_back({part.triangle, {p.at, q.at, r.at}});
  };
  const auto corner = [&](int k) { return Point{corners[k], part.corners[k]}; };
  const auto middle = [&](int e) {
    return Point{middles.of(corners, e), between(part.corners[e], part.corners[(e + 1) % 3], 0.5)};
  };
  const Point m = middle(a), n = middle(b), o = middle(c);
  if (n.vertex < 0) {
    add(m, corner(b), corner(c));
  } else {
    add(m, corner(b), n);
    add(m, n, corner(c));
  }
  if (o.vertex < 0) {
    add(corner(a), m, corner(c));
  } else {
    add(corner(a), m, o);
    add(o, m, corner(c));
  }
}

bool isBent(const RefinedSurface& surface, const Points& images, const std::array<int, 2>& ends,
            const std::array<Vec3, 3>& on, double chord) {
  const auto [a, b] = ends;
  if (!(norm(surface.positions[b] - surface.positions[a]) > chord)) return false;
  double bent = 0;
  for (std::size_t k = 0; k < kAlongEdge.size(); ++k)
    bent = std::max(bent, norm(on[k] - (images[a] + kAlongEdge[k] * (images[b] - images[a]))));
  return bent > chord;
}

// The middles of edges that are split: vertices at the end of the surface's and of the images.
class Splitting {
 public:
  // All edges are known; those that are split are known no more.
  Splitting(RefinedSurface& surface, Points& images, EdgeImages& known)
      : surface_(surface), images_(images), known_(known) {}

  // Of all edges in the first round; then of those that were looked at last.
  void splitBentEdges(bool firstRound, const std::vector<std::array<int, 2>>& last, double chord) {
    Middles bent;
    const auto look = [&](const std::array<int, 2>& ends, const std::array<Vec3, 3>& on) {
      if (isBent(surface_, images_, ends, on, chord)) bent.add(ends[0], ends[1], 0);
    };
    if (firstRound)
      for (const auto& [ends, on] : known_) look(ends, on);
    else
      for (const auto& ends : last) look(ends, known_.at(ends));
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
      const Triangle& corners = surface_.triangles[t];
      for (int e = 0; e < 3; ++e)
        if (bent.of(corners, e) >= 0) add(t, e);
    }
  }

  // Where an edge of a triangle is split, its longest one is too.
  void splitLongestEdges() {
    for (bool more = true; more;) {
      more = false;
      for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
        const Triangle& corners = surface_.triangles[t];
        if (middles_.any(corners) && add(t, longestEdge(surface_, corners))) more = true;
      }
    }
  }

  const Middles& middles() const { return middles_; }

 private:
  // False where it is there already.
  bool add(std::size_t t, int e) {
    const Triangle& corners = surface_.triangles[t];
    const int next = (e + 1) % 3, a = corners[e], b = corners[next];
    if (!middles_.add(a, b, static_cast<int>(surface_.vertices.size()))) return false;
    const RefinedSurface::Part& part = surface_.parts[t];
    surface_.vertices.push_back(
        {part.triangle, between(part.corners[e], part.corners[next], kAlongEdge[0])});
    surface_.positions.push_back(0.5 * (surface_.positions[a] + surface_.positions[b]));
    const auto known = known_.find({std::min(a, b), std::max(a, b)});
    images_.push_back(known->second[0]);
    known_.erase(known);
    return true;
  }

  RefinedSurface& surface_;
  Points& images_;
  EdgeImages& known_;
  Middles middles_;
};

}  // namespace

RefinedSurface::RefinedSurface(const Mesh& mesh)
    : vertices(mesh.vertices.size()), positions(mesh.vertices), triangles(mesh.triangles) {
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    parts.push_back({static_cast<int>(t), {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}});
    for (int k = 0; k < 3; ++k)
      vertices[triangles[t][k]] = {static_cast<int>(t), parts.back().corners[k]};
  }
}

void refine(RefinedSurface& surface, Points& images, EdgeImages& edges,
            const PlacesToPoints& imagesOf, double chord, std::size_t most) {
  int firstNew = 0;  // vertex, of the last round
  while (surface.triangles.size() < most) {
    const Edges unknown = unknownEdges(surface, edges, firstNew);
    lookAt(unknown, imagesOf, edges);
    Splitting splitting(surface, images, edges);
    const auto before = static_cast<int>(surface.vertices.size());
    splitting.splitBentEdges(firstNew == 0, unknown.ends, chord);
    if (splitting.middles().empty()) return;
    splitting.splitLongestEdges();
    firstNew = before;
    Triangulation next;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
      split(surface, t, splitting.middles(), next);
    surface.triangles = std::move(next.triangles);
    surface.parts = std::move(next.parts);
  }
}

}  // namespace innermap
