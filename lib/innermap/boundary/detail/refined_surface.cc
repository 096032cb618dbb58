#include "innermap/boundary/detail/refined_surface.h"

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace innermap {
namespace {

using Corner = std::array<double, 3>;

// Where an edge is looked at: one that is bent like an S is straight in its middle.
constexpr std::array<double, 3> kAlong{0.5, 0.25, 0.75};

Corner between(const Corner& a, const Corner& b, double t) {
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

std::uint64_t keyOf(int a, int b) {
  return (static_cast<std::uint64_t>(std::min(a, b)) << 32) |
         static_cast<std::uint64_t>(std::max(a, b));
}

struct Edges {
  std::vector<std::array<int, 2>> ends;
  std::vector<SurfacePoint> places;  // three an edge
};

// Each edge once but for those that are known to be straight.
Edges edgesOf(const RefinedSurface& surface, const std::unordered_set<std::uint64_t>& straight) {
  Edges out;
  std::unordered_set<std::uint64_t> seen;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (int e = 0; e < 3; ++e) {
      const int next = (e + 1) % 3;
      const int a = surface.triangles[t][e], b = surface.triangles[t][next];
      if (straight.count(keyOf(a, b)) > 0 || !seen.insert(keyOf(a, b)).second) continue;
      const RefinedSurface::Part& part = surface.parts[t];
      out.ends.push_back({a, b});
      for (const double along : kAlong)
        out.places.push_back({part.triangle, between(part.corners[e], part.corners[next], along)});
    }
  return out;
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

using Middles = std::unordered_map<std::uint64_t, int>;  // new vertices, by their edge

int middleOf(const Middles& middles, const Triangle& t, int e) {
  const auto found = middles.find(keyOf(t[e], t[(e + 1) % 3]));
  return found == middles.end() ? -1 : found->second;
}

// Cut from the middle of its longest edge to the corner across, and the halves where their other
// edge is split too.
void split(const RefinedSurface& from, std::size_t t, const Middles& middles, RefinedSurface& to) {
  const Triangle& corners = from.triangles[t];
  const RefinedSurface::Part& part = from.parts[t];
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
    return Point{middleOf(middles, corners, e),
                 between(part.corners[e], part.corners[(e + 1) % 3], 0.5)};
  };
  const Point m = middle(a), n = middle(b), o = middle(c);
  if (m.vertex < 0) return add(corner(0), corner(1), corner(2));
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

// The vertices in the middles of the edges that are bent, new ones at the end of the surface's and
// of `images`; the others go into `straight`.
Middles splitBentEdges(RefinedSurface& surface, Points& images, const PlacesToPoints& imagesOf,
                       double chord, std::unordered_set<std::uint64_t>& straight) {
  const Edges edges = edgesOf(surface, straight);
  const Points on = imagesOf(edges.places);
  Middles out;
  for (std::size_t i = 0; i < edges.ends.size(); ++i) {
    const auto [a, b] = edges.ends[i];
    const std::size_t first = kAlong.size() * i;
    double bent = 0;
    for (std::size_t k = 0; k < kAlong.size(); ++k) {
      const Vec3 line = images[a] + kAlong[k] * (images[b] - images[a]);
      bent = std::max(bent, norm(on[first + k] - line));
    }
    if (bent > chord && norm(surface.positions[b] - surface.positions[a]) > chord) {
      out.emplace(keyOf(a, b), static_cast<int>(surface.vertices.size()));
      surface.vertices.push_back(edges.places[first]);
      surface.positions.push_back(0.5 * (surface.positions[a] + surface.positions[b]));
      images.push_back(on[first]);
    } else {
      straight.insert(keyOf(a, b));
    }
  }
  return out;
}

// Where an edge of a triangle is split, its longest one is too.
void splitLongestEdges(RefinedSurface& surface, Points& images, const PlacesToPoints& imagesOf,
                       Middles& middles) {
  std::vector<SurfacePoint> places;
  const std::size_t first = surface.vertices.size();
  for (bool more = true; more;) {
    more = false;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
      const Triangle& corners = surface.triangles[t];
      const int e = longestEdge(surface, corners), next = (e + 1) % 3;
      const bool any = middleOf(middles, corners, 0) >= 0 || middleOf(middles, corners, 1) >= 0 ||
                       middleOf(middles, corners, 2) >= 0;
      if (!any || middleOf(middles, corners, e) >= 0) continue;
      middles.emplace(keyOf(corners[e], corners[next]), static_cast<int>(first + places.size()));
      const RefinedSurface::Part& part = surface.parts[t];
      places.push_back({part.triangle, between(part.corners[e], part.corners[next], 0.5)});
      surface.positions.push_back(
          0.5 * (surface.positions[corners[e]] + surface.positions[corners[next]]));
      more = true;
    }
  }
  const Points on = imagesOf(places);
  images.insert(images.end(), on.begin(), on.end());
  surface.vertices.insert(surface.vertices.end(), places.begin(), places.end());
}

}  // namespace

RefinedSurface::RefinedSurface(const Mesh& mesh)
    : vertices(mesh.vertices.size()), positions(mesh.vertices), triangles(mesh.triangles) {
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    parts.push_back({static_cast<int>(t), {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}});
    for (int k = 0; k < 3; ++k)
      vertices[triangles[t][k]] = {static_cast<int>(t), parts.back().corners[k]};
  }
}

void refine(RefinedSurface& surface, Points& images, const PlacesToPoints& imagesOf, double chord,
            std::size_t most) {
  std::unordered_set<std::uint64_t> straight;
  while (surface.triangles.size() < most) {
    Middles middles = splitBentEdges(surface, images, imagesOf, chord, straight);
    if (middles.empty()) return;
    splitLongestEdges(surface, images, imagesOf, middles);
    RefinedSurface next = surface;
    next.triangles.clear();
    next.parts.clear();
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) split(surface, t, middles, next);
    surface = std::move(next);
  }
}

}  // namespace innermap
