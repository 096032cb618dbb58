#include "innermap/transfer/geometry.h"

#include <algorithm>
#include <utility>

#include "innermap/core/error.h"
#include "mesh/triangulate.h"

namespace innermap {
namespace {

std::uint64_t keyOf(int a, int b) {
  return static_cast<std::uint64_t>(std::min(a, b)) << 32 |
         static_cast<std::uint32_t>(std::max(a, b));
}

class Splitter {
 public:
  Splitter(Geometry& geometry, const std::vector<std::array<int, 2>>& edges) : geometry_(geometry) {
    Geometry& g = geometry_;
    if (g.pointMiddles.originals() == 0) {
      g.pointMiddles.begin(g.points.size());
      g.textureMiddles.begin(g.textures);
      if (g.cornerDirections) g.directionMiddles.begin(g.directions[0].values.size());
    }
    if (g.points.size() + edges.size() > static_cast<std::size_t>(1) << 31)
      throw DataError("subdivide: over 2147483648 points; take a larger tolerance");
    for (const auto& [a, b] : edges) {
      const int middle = g.pointMiddles.between(a, b);
      if (middle < static_cast<int>(g.points.size())) continue;
      g.points.push_back(0.5 * (g.points[a] + g.points[b]));
      for (std::size_t d = g.cornerDirections; d < g.directions.size(); ++d)
        addDirection(g.directions[d], a, b, middle);
    }
    g.ownPoints = g.points.size();
  }

  void run() {
    const Elements before = std::move(geometry_.elements);
    geometry_.elements = {};
    std::vector<Corner> corners;
    for (std::size_t e = 0; e < before.size(); ++e) {
      kind_ = before.kinds[e];
      source_ = before.source[e];
      corners.assign(before.corners.begin() + static_cast<std::ptrdiff_t>(before.start[e]),
                     before.corners.begin() + static_cast<std::ptrdiff_t>(before.start[e + 1]));
      if (kind_ == Elements::Kind::line)
        splitLine(corners);
      else if (kind_ == Elements::Kind::face && anySplit(corners))
        splitFace(corners);
      else
        add(corners);
    }
  }

 private:
  // Of directions at points, number i is at point i.
  static void addDirection(Directions& directions, int a, int b, int point) {
    const Vec3 from = directions.values[a], to = directions.values[b];
    Vec3 mean = 0.5 * (from + to);
    const double length = norm(mean);
    if (directions.kind == DirectionKind::normal && length > 0)
      mean = 0.5 * (norm(from) + norm(to)) / length * mean;
    directions.values.push_back(mean);
    directions.points.push_back(point);
  }

  bool isSplit(const Corner& a, const Corner& b) const {
    return geometry_.pointMiddles.find(a.point, b.point) >= 0;
  }

  bool anySplit(const std::vector<Corner>& corners) const {
    for (std::size_t k = 0; k < corners.size(); ++k)
      if (isSplit(corners[k], corners[(k + 1) % corners.size()])) return true;
    return false;
  }

  Corner middle(const Corner& a, const Corner& b) {
    Geometry& g = geometry_;
    Corner out;
    out.point = g.pointMiddles.find(a.point, b.point);
    out.texture = g.textureMiddles.between(a.texture, b.texture);
    if (g.cornerDirections && a.direction >= 0 && b.direction >= 0) {
      out.direction = g.directionMiddles.between(a.direction, b.direction);
      Directions& d = g.directions[0];
      if (out.direction == static_cast<int>(d.values.size()))
        addDirection(d, a.direction, b.direction, out.point);
    }
    return out;
  }

  void add(const std::vector<Corner>& corners) {
    geometry_.elements.add(kind_, source_, corners.data(), corners.size());
  }

  void splitLine(const std::vector<Corner>& corners) {
    std::vector<Corner> out;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      out.push_back(corners[k]);
      if (k + 1 < corners.size() && isSplit(corners[k], corners[k + 1]))
        out.push_back(middle(corners[k], corners[k + 1]));
    }
    add(out);
  }

  void splitFace(const std::vector<Corner>& corners) {
    if (corners.size() == 3) return splitTriangle(corners[0], corners[1], corners[2]);
    Points places;
    std::vector<int> order;
    for (const Corner& c : corners) {
      order.push_back(static_cast<int>(places.size()));
      places.push_back(geometry_.points[c.point]);
    }
    std::vector<Triangle> triangles;
    triangulatePolygon(places, order.data(), static_cast<int>(order.size()), triangles);
    for (const Triangle& t : triangles) splitTriangle(corners[t[0]], corners[t[1]], corners[t[2]]);
  }

  void splitTriangle(Corner a, Corner b, Corner c) {
    const int split = isSplit(a, b) + isSplit(b, c) + isSplit(c, a);
    // Turned so that a b is split where one is, c a is not where one is not.
    while (split == 1 && !isSplit(a, b)) std::tie(a, b, c) = std::make_tuple(b, c, a);
    while (split == 2 && isSplit(c, a)) std::tie(a, b, c) = std::make_tuple(b, c, a);
    if (split == 0) return add({a, b, c});
    const Corner ab = middle(a, b);
    if (split == 1) {
      add({a, ab, c});
      return add({ab, b, c});
    }
    const Corner bc = middle(b, c);
    if (split == 2) {
      add({ab, b, bc});
      const Points& p = geometry_.points;
      const bool first = norm(p[a.point] - p[bc.point]) <= norm(p[ab.point] - p[c.point]);
      if (first) {
        add({a, ab, bc});
        return add({a, bc, c});
      }
      add({a, ab, c});
      return add({ab, bc, c});
    }
    const Corner ca = middle(c, a);
    add({a, ab, ca});
    add({ab, b, bc});
    add({ca, bc, c});
    add({ab, bc, ca});
  }

  Geometry& geometry_;
  Elements::Kind kind_ = Elements::Kind::face;
  std::uint32_t source_ = 0;
};

}  // namespace

void Elements::add(Kind kind, std::uint32_t from, const Corner* begin, std::size_t count) {
  corners.insert(corners.end(), begin, begin + count);
  start.push_back(corners.size());
  kinds.push_back(kind);
  source.push_back(from);
}

int Midpoints::between(int a, int b) {
  if (a < 0 || b < 0) return -1;
  if (a == b) return a;
  const auto next = static_cast<int>(originals_ + parents_.size());
  const auto [found, isNew] = made_.try_emplace(keyOf(a, b), next);
  if (isNew) parents_.push_back({a, b});
  return found->second;
}

int Midpoints::find(int a, int b) const {
  const auto found = made_.find(keyOf(a, b));
  return found == made_.end() ? -1 : found->second;
}

void splitEdges(Geometry& geometry, const std::vector<std::array<int, 2>>& edges) {
  Splitter(geometry, edges).run();
}

std::vector<std::array<int, 2>> edgesOf(const Geometry& geometry) {
  const Elements& elements = geometry.elements;
  std::vector<std::array<int, 2>> edges;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const bool face = elements.kinds[e] == Elements::Kind::face;
    if (!face && elements.kinds[e] != Elements::Kind::line) continue;
    const std::size_t begin = elements.start[e], count = elements.start[e + 1] - begin;
    for (std::size_t k = 0; k + !face < count; ++k) {
      const int a = elements.corners[begin + k].point,
                b = elements.corners[begin + (k + 1) % count].point;
      if (a != b) edges.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

}  // namespace innermap
