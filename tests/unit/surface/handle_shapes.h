// Closed surfaces with handles for the tests of surface/.
#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "core/random.h"
#include "innermap/surface/correspond.h"
#include "mesh/shapes.h"

namespace innermap::shapes {

inline ClosedSurface closed(const Mesh& mesh, int genus) {
  return {mesh.name, mesh.vertices, mesh.triangles, genus};
}

inline Vec3 pointOn(const ClosedSurface& surface, const SurfacePoint& p) {
  Vec3 out;
  for (std::size_t k = 0; k < 3; ++k)
    out += p.barycentric[k] *
           surface.vertices[surface.triangles[static_cast<std::size_t>(p.triangle)][k]];
  return out;
}

inline ClosedSurface turnedInsideOut(ClosedSurface surface) {
  for (Triangle& t : surface.triangles) std::swap(t[1], t[2]);
  return surface;
}

// The same surface moved by up to `size` at each vertex.
inline ClosedSurface shaken(ClosedSurface surface, double size, std::uint64_t seed = 1) {
  const CounterRandom random(seed, 0);
  std::uint64_t drawn = 0;
  for (Vec3& v : surface.vertices)
    for (int axis = 0; axis < 3; ++axis) v[axis] += size * (2 * random.uniform(drawn++) - 1);
  return surface;
}

// A share of the vertices moved onto a neighbour: triangles without area, edges without length.
inline ClosedSurface degenerated(ClosedSurface surface, double share, std::uint64_t seed = 2) {
  const CounterRandom random(seed, 0);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    if (random.uniform(t) < 0.5 * share)
      surface.vertices[surface.triangles[t][0]] = surface.vertices[surface.triangles[t][1]];
  return surface;
}

// A tube of n rings of m vertices around a closed curve of period 1. Vertex i * m + j is the j-th
// of the i-th ring.
inline ClosedSurface tube(const std::function<Vec3(double)>& curve, int n, int m, double radius) {
  ClosedSurface out;
  out.name = "tube";
  out.genus = 1;
  Vec3 side{0.3, 0.5, 0.8};
  for (int i = 0; i < n; ++i) {
    const double s = static_cast<double>(i) / n, step = 0.5 / n;
    Vec3 along = curve(s + step) - curve(s - step);
    along = along / norm(along);
    side = side - dot(side, along) * along;
    side = side / norm(side);
    const Vec3 up = cross(along, side);
    for (int j = 0; j < m; ++j) {
      const double angle = 2 * kPi * j / m;
      out.vertices.push_back(curve(s) + radius * (std::cos(angle) * side + std::sin(angle) * up));
    }
  }
  // The last ring meets the first turned: joined where it is nearest.
  int turn = 0;
  const auto gap = [&](int k) {
    return squaredNorm(out.vertices[static_cast<std::size_t>((n - 1) * m)] -
                       out.vertices[static_cast<std::size_t>(k)]);
  };
  for (int k = 1; k < m; ++k)
    if (gap(k) < gap(turn)) turn = k;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const int shift = i + 1 == n ? turn : 0, row = (i + 1) % n * m;
      const int a = i * m + j, b = row + (j + shift) % m, c = row + (j + 1 + shift) % m,
                d = i * m + (j + 1) % m;
      out.triangles.push_back({a, c, b});
      out.triangles.push_back({a, d, c});
    }
  }
  return out;
}

inline Vec3 circle(double s) { return {std::cos(2 * kPi * s), std::sin(2 * kPi * s), 0}; }

inline Vec3 trefoil(double s) {
  const double u = 2 * kPi * s;
  return {std::sin(u) + 2 * std::sin(2 * u), std::cos(u) - 2 * std::cos(2 * u), -std::sin(3 * u)};
}

using Cell = std::array<int, 3>;
using Cells = std::set<Cell>;

inline Cells block(Cell lower, Cell upper) {  // both included
  Cells out;
  for (int x = lower[0]; x <= upper[0]; ++x)
    for (int y = lower[1]; y <= upper[1]; ++y)
      for (int z = lower[2]; z <= upper[2]; ++z) out.insert({x, y, z});
  return out;
}

inline Cells without(Cells a, const Cells& b) {
  for (const Cell& c : b) a.erase(c);
  return a;
}

inline Cells with(Cells a, const Cells& b) {
  a.insert(b.begin(), b.end());
  return a;
}

// Each cell cut in n^3.
inline Cells finer(const Cells& cells, int n) {
  Cells out;
  for (const Cell& c : cells)
    out = with(std::move(out), block({n * c[0], n * c[1], n * c[2]},
                                     {n * c[0] + n - 1, n * c[1] + n - 1, n * c[2] + n - 1}));
  return out;
}

// The boundary of unit cubes, which must not touch along edges or in corners only.
inline ClosedSurface boundaryOf(const Cells& cells, int genus) {
  ClosedSurface out;
  out.name = "cells";
  out.genus = genus;
  std::map<Cell, int> number;
  const auto vertex = [&](const Cell& c) {
    const auto [found, isNew] = number.try_emplace(c, static_cast<int>(out.vertices.size()));
    if (isNew)
      out.vertices.push_back(
          {static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])});
    return found->second;
  };
  for (const Cell& c : cells) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int side = 0; side < 2; ++side) {
        Cell beside = c;
        beside[axis] += side ? 1 : -1;
        if (cells.count(beside)) continue;
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        Cell corner = c;
        corner[axis] += side;
        Cell p = corner, q = corner, r = corner;
        ++p[u], ++q[u], ++q[v], ++r[v];
        const int i = vertex(corner), j = vertex(p), k = vertex(q), l = vertex(r);
        if (side) {
          out.triangles.push_back({i, j, k});
          out.triangles.push_back({i, k, l});
        } else {
          out.triangles.push_back({i, k, j});
          out.triangles.push_back({i, l, k});
        }
      }
    }
  }
  return out;
}

// A trefoil of cells: columns c of a grid diagram from row c to row c + 2 modulo 5 above rows.
inline Cells trefoilCells() {
  Cells out;
  for (int c = 0; c < 5; ++c) {
    const int row = (c + 2) % 5;
    out = with(out, block({2 * c, 2 * std::min(c, row), 2}, {2 * c, 2 * std::max(c, row), 2}));
    out = with(out, block({2 * std::min(c, row), 2 * row, 0}, {2 * std::max(c, row), 2 * row, 0}));
    out.insert({2 * c, 2 * c, 1});
    out.insert({2 * c, 2 * row, 1});
  }
  return out;
}

// A plate of cells with holes in a row; bars between them are one cell wide and two high.
inline Cells plateCells(int holes) {
  Cells cells = block({0, 0, 0}, {4 * holes, 4, 1});
  for (int i = 0; i < holes; ++i)
    cells = without(std::move(cells), block({4 * i + 1, 1, 0}, {4 * i + 3, 3, 1}));
  return cells;
}

inline ClosedSurface plate(int holes, int fineness = 1) {
  return boundaryOf(finer(plateCells(holes), fineness), holes);
}

// A block with a tunnel along the trefoil, which comes up to the top twice.
inline Cells knottedTunnel() {
  Cells tunnel = trefoilCells();
  for (int y = 1; y < 4; ++y) tunnel.erase({0, y, 2});
  tunnel = with(tunnel, block({0, 0, 2}, {0, 0, 4}));
  tunnel = with(tunnel, block({0, 4, 2}, {0, 4, 4}));
  return without(block({-2, -2, -2}, {10, 10, 4}), tunnel);
}

}  // namespace innermap::shapes
