#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/require_number.h"
#include "innermap/core/run.h"
#include "innermap/tetra/hexahedralize.h"
#include "lattice/cell_signs.h"
#include "tetra/detail/hexahedron_bounds.h"

namespace innermap {
namespace {

constexpr int kMostHalvings = 10;
constexpr std::size_t kCellsABlock = 512;

using Coefficients = std::array<double, 27>;  // x fastest

constexpr double kEpsilon = 0x1.0p-53;
// What underflows in products of three edges below kLongest comes to less.
constexpr double kLongest = 0x1.0p+300, kUnderflow = 0x1.0p-760;

struct Rounded {
  Coefficients values{};
  double rounding = 0;  // what margins are multiples of
};

// The largest of each component's sizes.
Vec3 largestOf(const std::array<Vec3, 4>& edges) {
  Vec3 out;
  for (const Vec3& e : edges)
    for (int a = 0; a < 3; ++a) out[a] = std::max(out[a], std::abs(e[a]));
  return out;
}

// Forward error analysis (Higham, "Accuracy and Stability of Numerical Algorithms", 2002, 3.1). A
// term of a coefficient goes through three roundings of its edges, two of the cross product, three
// of the dot product, and seven of the sum of eight of them: 15. They are relative to the terms'
// sizes, which sum to the permanent of the largest edges at most, as the weights sum to 1. 24 has
// room for the permanent's own roundings. Halving once rounds six times, and makes no coefficient
// larger.
double roundingOf(const std::array<std::array<Vec3, 4>, 3>& edges) {
  const Vec3 u = largestOf(edges[0]), v = largestOf(edges[1]), w = largestOf(edges[2]);
  if (!(std::max({u.x, u.y, u.z, v.x, v.y, v.z, w.x, w.y, w.z}) < kLongest))
    return std::numeric_limits<double>::infinity();
  return kEpsilon * (u.x * (v.y * w.z + v.z * w.y) + u.y * (v.z * w.x + v.x * w.z) +
                     u.z * (v.x * w.y + v.y * w.x));
}

double marginOf(double unit, int halvings) { return (24 + 8 * halvings) * unit + kUnderflow; }

// p in the order of the bits (x, y, z). The gradient's columns are bilinear, with the edges along
// their axes as coefficients; a product of Bernstein polynomials is one, with binomial weights.
Rounded coefficientsOf(const std::array<Vec3, 8>& p) {
  std::array<std::array<Vec3, 4>, 3> edges;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t low = k & 1, high = k >> 1;
    edges[0][k] = p[1 + 2 * low + 4 * high] - p[2 * low + 4 * high];  // by y, z
    edges[1][k] = p[2 + low + 4 * high] - p[low + 4 * high];          // by x, z
    edges[2][k] = p[4 + low + 2 * high] - p[low + 2 * high];          // by x, y
  }
  Rounded out;
  for (std::size_t v = 0; v < 4; ++v)
    for (std::size_t w = 0; w < 4; ++w) {
      const Vec3 normal = cross(edges[1][v], edges[2][w]);
      for (std::size_t u = 0; u < 4; ++u) {
        const std::size_t x = (v & 1) + (w & 1), y = (u & 1) + (w >> 1), z = (u >> 1) + (v >> 1);
        out.values[x + 3 * y + 9 * z] += dot(edges[0][u], normal);
      }
    }
  for (std::size_t i = 0; i < 27; ++i)
    for (const std::size_t stride : {1, 3, 9})
      if (i / stride % 3 == 1) out.values[i] *= 0.5;
  out.rounding = roundingOf(edges);
  return out;
}

// The half of the cube along an axis (stride), by de Casteljau.
Coefficients halfOf(const Coefficients& c, int stride, bool upper) {
  Coefficients out;
  for (int i = 0; i < 27; ++i) {
    if (i / stride % 3 != 1) continue;
    const double a = c[i - stride], b = c[i], d = c[i + stride];
    const double ab = 0.5 * (a + b), bd = 0.5 * (b + d), middle = 0.5 * (ab + bd);
    out[i - stride] = upper ? middle : a;
    out[i] = upper ? bd : ab;
    out[i + stride] = upper ? d : middle;
  }
  return out;
}

JacobianBounds boundsOf(const Coefficients& c, double margin) {
  JacobianBounds out{c[0], c[0]};
  for (int i = 0; i < 27; ++i) {
    out.lower = std::min(out.lower, c[i]);
    if (i % 3 != 1 && i / 3 % 3 != 1 && i / 9 != 1) out.upper = std::min(out.upper, c[i]);
  }
  return {out.lower - margin, out.upper + margin};
}

// No smaller part of it can be told from 0.
bool allWithin(const Coefficients& c, double margin) {
  return std::all_of(c.begin(), c.end(), [&](double x) { return std::abs(x) <= margin; });
}

// Halves what is not decided.
void refine(const Rounded& cell, int halvings, JacobianBounds& out) {
  std::vector<Coefficients> parts{cell.values};
  double decided = std::numeric_limits<double>::infinity();  // of the parts that were left behind
  for (int h = 1; h <= halvings && !parts.empty() && !out.proven() && !out.inverted(); ++h) {
    const double margin = marginOf(cell.rounding, h);
    std::vector<Coefficients> smaller;
    double lower = decided;
    for (const Coefficients& part : parts)
      for (int o = 0; o < 8 && !out.inverted(); ++o) {
        const Coefficients c = halfOf(halfOf(halfOf(part, 1, o & 1), 3, o >> 1 & 1), 9, o >> 2 & 1);
        const JacobianBounds bounds = boundsOf(c, margin);
        out.upper = std::min(out.upper, bounds.upper);
        lower = std::min(lower, bounds.lower);
        if (bounds.proven() || allWithin(c, margin))
          decided = std::min(decided, bounds.lower);
        else
          smaller.push_back(c);
      }
    parts = std::move(smaller);
    // Where it ended early, as the cell is inverted, the first bound is the one that holds.
    if (!out.inverted()) out.lower = std::max(out.lower, lower);
  }
}

}  // namespace

JacobianBounds leastJacobian(const Points& vertices, const Hexahedron& cell, int halvings) {
  std::uint64_t exact = 0;
  return leastJacobian(vertices, cell, halvings, exact);
}

JacobianBounds leastJacobian(const Points& vertices, const Hexahedron& cell, int halvings,
                             std::uint64_t& exact) {
  constexpr int kOrder[8] = {0, 1, 3, 2, 4, 5, 7, 6};  // from VTK's order to that of bits
  std::array<Vec3, 8> p;
  for (int i = 0; i < 8; ++i) p[i] = vertices[cell[kOrder[i]]];
  const Rounded c = coefficientsOf(p);
  const double margin = marginOf(c.rounding, 0);
  JacobianBounds out = boundsOf(c.values, margin);
  if (!std::isfinite(margin)) out = {-margin, margin};
  if (out.proven() || out.inverted()) return out;
  // At a corner the sign is known whatever the margin.
  if (out.upper <= 2 * margin)
    for (const Tetrahedron& t : cornerTetrahedra(cell)) {
      const Sign s = signOf(vertices, t, exact);
      if (s == Sign::negative || s == Sign::zero) out.upper = 0;
    }
  if (!allWithin(c.values, margin)) refine(c, std::clamp(halvings, 0, kMostHalvings), out);
  return out;
}

HexahedronCheck checkHexahedra(const CellMesh& mesh, const HexahedronCheckSettings& settings) {
  requireNumber("halvings", settings.halvings, {0, kMostHalvings});
  const std::size_t count = mesh.hexahedra.size();
  std::vector<HexahedronCheck> parts((count + kCellsABlock - 1) / kCellsABlock);
  parallelBlocks(
      count, kCellsABlock,
      [&](std::size_t begin, std::size_t end) {
        HexahedronCheck& part = parts[begin / kCellsABlock];
        for (std::size_t i = begin; i < end; ++i) {
          const Hexahedron& cell = mesh.hexahedra[i];
          const JacobianBounds bounds =
              leastJacobian(mesh.vertices, cell, settings.halvings, part.exact);
          if (bounds.proven()) continue;
          if (!bounds.inverted()) {
            ++part.undecided;
            continue;
          }
          ++part.inverted;
          part.invertedCorners += isInverted(mesh.vertices, cell);
        }
      },
      "checking hexahedra");
  HexahedronCheck out;
  for (const HexahedronCheck& part : parts) {
    out.inverted += part.inverted;
    out.invertedCorners += part.invertedCorners;
    out.undecided += part.undecided;
    out.exact += part.exact;
  }
  return out;
}

}  // namespace innermap
