#include "surface/detail/torus/torus_layout.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "innermap/core/error.h"
#include "surface/detail/topology/half_edges.h"
#include "surface/detail/topology/knot.h"
#include "surface/detail/topology/meridians.h"
#include "surface/detail/torus/torus_relaxation.h"

namespace innermap {
namespace {

// The number of periods between the corners of each triangle: of the closed one-forms that count
// how often a path runs along the meridian and along the longitude.
std::vector<CornerShifts> cornerShifts(const HomologyBasis& basis, const TorusClasses& classes,
                                       const HalfEdges& edges) {
  const Integers &m = classes.meridian, &l = classes.longitude;
  const long long det = m[0] * l[1] - m[1] * l[0];  // plus or minus 1
  const std::vector<int> alongMeridian = combinedForm(basis, {l[1] * det, -l[0] * det}, edges);
  const std::vector<int> alongLongitude = combinedForm(basis, {-m[1] * det, m[0] * det}, edges);
  std::vector<CornerShifts> shift(static_cast<std::size_t>(edges.size()) / 3);
  for (std::size_t t = 0; t < shift.size(); ++t) {
    for (std::size_t k = 0; k < 2; ++k)
      shift[t][k + 1] = shift[t][k] + Shift{alongMeridian[3 * t + k], alongLongitude[3 * t + k]};
  }
  return shift;
}

// Names the longitudes anew so that period[1] is as short as possible and turns period[0] along x.
void normalize(Layout& layout) {
  const Vec3 p = layout.period[0], q = layout.period[1];
  const int twist = -static_cast<int>(std::lround(dot(p, q) / squaredNorm(p)));
  const double length = norm(p), c = p.x / length, s = p.y / length;
  const auto turned = [&](const Vec3& v) {
    return Vec3{c * v.x + s * v.y, c * v.y - s * v.x, v.z};
  };
  layout.period = {turned(p), turned(q + static_cast<double>(twist) * p)};
  layout.period[0].y = 0;
  for (Vec3& x : layout.place) x = turned(x);
  for (CornerShifts& corners : layout.shift)
    for (Shift& shift : corners) shift.a -= twist * shift.b;
}

}  // namespace

Layout layOutTorus(const ClosedSurface& surface) {
  const HalfEdges edges(surface.triangles);
  const HomologyBasis basis = homologyBasis(surface, edges);
  if (basis.size() != 2)
    throw DataError(fmt::format("{}: has {} handles, not one", surface.name, basis.size() / 2));
  const TorusClasses classes = torusClasses(surface, edges, basis);
  Layout layout = relaxedTorus(surface, cornerShifts(basis, classes, edges));
  normalize(layout);
  moveIntoCell(surface.triangles, layout);
  if (isKnotted(meridianCurve(surface, layout)))
    throw DataError(fmt::format(
        "{}: no loop around its handle bounds a disc inside the solid, as the tunnel is knotted; "
        "such solids cannot be mapped without cutting the tunnel open",
        surface.name));
  return layout;
}

void moveIntoCell(const std::vector<Triangle>& triangles, Layout& layout) {
  const Vec3 &p = layout.period[0], &q = layout.period[1];
  const double area = p.x * q.y - p.y * q.x;
  std::vector<Shift> home(layout.place.size());
  for (std::size_t v = 0; v < layout.place.size(); ++v) {
    Vec3& x = layout.place[v];
    home[v] = {-static_cast<int>(std::floor((x.x * q.y - x.y * q.x) / area)),
               -static_cast<int>(std::floor((p.x * x.y - p.y * x.x) / area))};
    x = layout.moved(x, home[v]);
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k)
      layout.shift[t][k] = layout.shift[t][k] - home[triangles[t][k]];
    const Shift first = layout.shift[t][0];
    for (Shift& shift : layout.shift[t]) shift = shift - first;
  }
}

Points meridianCurve(const ClosedSurface& surface, const Layout& layout) {
  constexpr int kLines = 16;
  const std::vector<Triangle>& triangles = surface.triangles;
  const HalfEdges edges(triangles);
  const Vec3 direction = layout.period[0];
  // Distance to the left of the line through the origin along it.
  const auto height = [&](const Vec3& p) { return direction.x * p.y - direction.y * p.x; };
  const double rise = height(layout.period[1]);
  Points shortest;
  double least = std::numeric_limits<double>::infinity();
  for (int line = 0; line < kLines; ++line) {
    const int first = static_cast<int>(triangles.size() * static_cast<std::size_t>(line) / kLines);
    double level = 0;
    for (int k = 0; k < 3; ++k)
      level += (0.3 + 0.03 * k) / 0.99 * height(layout.corner(triangles, first, k));
    // A triangle's copy is b cells up from its own frame.
    int b = 0;
    const auto above = [&](int h) {
      const int t = h / 3, k = h % 3;
      const Vec3& p = layout.place[triangles[t][k]];
      return height(p) + (b + layout.shift[t][k].b) * rise +
             layout.shift[t][k].a * height(layout.period[0]) - level;
    };
    int h = 3 * first;
    while (above(h) >= 0 || above(HalfEdges::next(h)) < 0) h = HalfEdges::next(h);
    const int start = h;
    Points points;
    double length = 0;
    do {
      const double below = above(h), over = above(HalfEdges::next(h));
      const Vec3 &p = surface.vertices[edges.tail(h)], &q = surface.vertices[edges.head(h)];
      points.push_back(p + below / (below - over) * (q - p));
      if (points.size() > 1) length += norm(points.back() - points[points.size() - 2]);
      const int other = edges.opposite(h);
      b += layout.shift[h / 3][h % 3].b - layout.shift[other / 3][(other % 3 + 1) % 3].b;
      // Entered with the head above, now the tail of `other`.
      h = above(HalfEdges::previous(other)) < 0 ? HalfEdges::previous(other)
                                                : HalfEdges::next(other);
    } while (h != start && points.size() < triangles.size());
    length += norm(points.back() - points.front());
    if (!(length < least)) continue;
    least = length;
    shortest = std::move(points);
  }
  return shortest;
}

}  // namespace innermap
