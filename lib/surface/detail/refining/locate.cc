#include "surface/detail/refining/locate.h"

#include <algorithm>
#include <cmath>

namespace innermap {
namespace {

Vec3 latticeCoordinates(const Vec3& p, const std::array<Vec3, 2>& period) {
  const double d = period[0].x * period[1].y - period[0].y * period[1].x;
  return {(p.x * period[1].y - p.y * period[1].x) / d, (period[0].x * p.y - period[0].y * p.x) / d,
          0};
}

}  // namespace

Locator::Locator(const std::vector<Triangle>& triangles, const Layout& layout)
    : periodic_(layout.space == ModelSpace::torus),
      period_(layout.period),
      cones_(triangles.size()),
      longestWalk_(200 + 8 * static_cast<int>(std::sqrt(static_cast<double>(triangles.size())))) {
  const Neighbours neighbours = neighboursOf(triangles);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    Cone& cone = cones_[t];
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = layout.corner(triangles, static_cast<int>(t), (k + 1) % 3),
                 b = layout.corner(triangles, static_cast<int>(t), (k + 2) % 3);
      cone.side[k] = cross(a, b - a);
      cone.next[k] = neighbours[t][k].triangle;
    }
  }
  if (periodic_) {
    crossing_.resize(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const Neighbour n = neighbours[t][k];
        crossing_[t][k] =
            layout.shift[t][(k + 1) % 3] - layout.shift[n.triangle][(n.corner + 2) % 3];
      }
  }
  const std::size_t faces = periodic_ ? 1 : 6;
  cells_ = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(triangles.size()) /
                                                 static_cast<double>(faces))),
                      1, 512);
  const std::size_t cells =
      faces * static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_);
  hints_.assign(cells, Located{0, {}});
  Located last{0, {}};
  for (std::size_t c = 0; c < cells; ++c) hints_[c] = last = find(cellCenter(c), last);
}

Vec3 Locator::cellCenter(std::size_t cell) const {
  const std::size_t n = static_cast<std::size_t>(cells_), face = cell / (n * n);
  const std::size_t row = (cell / n) % n;
  // Back and forth, so that each cell is next to the one before.
  const std::size_t column = row % 2 == 0 ? cell % n : n - 1 - cell % n;
  const double u = (static_cast<double>(column) + 0.5) / static_cast<double>(cells_),
               v = (static_cast<double>(row) + 0.5) / static_cast<double>(cells_);
  if (periodic_) return Vec3{0, 0, 1} + (u * period_[0] + v * period_[1]);
  const int axis = static_cast<int>(face / 2);
  Vec3 p;
  p[axis] = face % 2 == 0 ? 1 : -1;
  p[(axis + 1) % 3] = 2 * u - 1;
  p[(axis + 2) % 3] = 2 * v - 1;
  return p / norm(p);
}

std::size_t Locator::cellOf(const Vec3& p, Shift* shift) const {
  double u = 0, v = 0;
  std::size_t face = 0;
  if (periodic_) {
    const Vec3 q = latticeCoordinates(p, period_);
    *shift = {static_cast<int>(std::floor(q.x)), static_cast<int>(std::floor(q.y))};
    u = q.x - shift->a;
    v = q.y - shift->b;
  } else {
    int axis = 0;
    for (int a = 1; a < 3; ++a)
      if (std::abs(p[a]) > std::abs(p[axis])) axis = a;
    face = 2 * static_cast<std::size_t>(axis) + (p[axis] < 0 ? 1 : 0);
    const double m = std::abs(p[axis]);
    u = 0.5 * (p[(axis + 1) % 3] / m + 1);
    v = 0.5 * (p[(axis + 2) % 3] / m + 1);
  }
  const auto index = [&](double x) {
    return static_cast<std::size_t>(
        std::clamp(static_cast<int>(x * cells_), 0, cells_ - 1));  // NaN: 0
  };
  const std::size_t n = static_cast<std::size_t>(cells_), row = index(v);
  const std::size_t column = row % 2 == 0 ? index(u) : n - 1 - index(u);
  return (face * n + row) * n + column;
}

Located Locator::hintFor(const Vec3& p) const {
  Shift shift;
  Located hint = hints_[cellOf(p, &shift)];
  hint.shift = hint.shift + shift;
  return hint;
}

// w: p's in the hint.
Located Locator::walk(const Vec3& p, const Located& hint, Weights& w) const {
  Located at = hint;
  // Where a step is to begin looking for a way out: not the same side always, or walks may circle.
  unsigned turn = 0;
  for (int i = 0; i < longestWalk_; ++i) {
    // Most walks are a step or two long: out by the side that is farthest away at first.
    int leave = w[0] < w[1] ? 0 : 1;
    if (w[2] < w[leave]) leave = 2;
    if (w[leave] >= 0) return at;
    const double rounding = -1e-14 * (std::abs(w[0]) + std::abs(w[1]) + std::abs(w[2]));
    if (w[leave] >= rounding) return at;
    if (i >= 16) {
      turn = turn * 1664525u + 1013904223u;
      for (unsigned j = 0; j < 3; ++j) {
        const int k = static_cast<int>(((turn >> 16) + j) % 3);
        if (w[k] < rounding) leave = k;
      }
    }
    if (periodic_) at.shift = at.shift + crossing_[at.triangle][leave];
    at.triangle = cones_[at.triangle].next[leave];
    w = cones_[at.triangle].weights(local(p, at));
  }
  at = search(p, hint);
  w = cones_[at.triangle].weights(local(p, at));
  return at;
}

// The triangle whose least weight, as a share, is largest.
Located Locator::search(const Vec3& p, const Located& hint) const {
  Located best = hint;
  double least = -1e300;
  for (int a = periodic_ ? -1 : 0; a <= (periodic_ ? 1 : 0); ++a)
    for (int b = periodic_ ? -1 : 0; b <= (periodic_ ? 1 : 0); ++b) {
      Shift home;
      if (periodic_) cellOf(p, &home);
      for (std::size_t t = 0; t < cones_.size(); ++t) {
        const Located at{static_cast<int>(t), home + Shift{a, b}};
        const std::array<double, 3> w = cones_[t].weights(local(p, at));
        const double sum = w[0] + w[1] + w[2];
        const double inside = sum > 0 ? std::min({w[0], w[1], w[2]}) / sum : -1e299;
        if (inside > least) {
          least = inside;
          best = at;
        }
      }
    }
  return best;
}

std::array<double, 3> Locator::barycentric(const Vec3& p, const Located& where) const {
  std::array<double, 3> w = cones_[where.triangle].weights(local(p, where));
  for (double& x : w) x = std::max(x, 0.0);
  const double sum = w[0] + w[1] + w[2];
  if (!(sum > 0)) return {1, 0, 0};
  for (double& x : w) x /= sum;
  return w;
}

}  // namespace innermap
