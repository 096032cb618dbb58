#include <algorithm>
#include <array>
#include <vector>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/tetra/hexahedralize.h"

namespace innermap {
namespace {

constexpr int kMostHalvings = 10;
constexpr std::size_t kCellsABlock = 512;

using Coefficients = std::array<double, 27>;  // x fastest

// The determinant of the trilinear map's gradient.
double determinantAt(const std::array<Vec3, 8>& p, double u, double v, double w) {
  const auto between = [](const Vec3& a, const Vec3& b, double s) { return (1 - s) * a + s * b; };
  // p in the order of the bits (x, y, z).
  const Vec3 du = between(between(p[1] - p[0], p[3] - p[2], v),
                          between(p[5] - p[4], p[7] - p[6], v), w),
             dv = between(between(p[2] - p[0], p[3] - p[1], u),
                          between(p[6] - p[4], p[7] - p[5], u), w),
             dw = between(between(p[4] - p[0], p[5] - p[1], u),
                          between(p[6] - p[2], p[7] - p[3], u), v);
  return dot(du, cross(dv, dw));
}

Coefficients coefficientsOf(const std::array<Vec3, 8>& p) {
  Coefficients c;
  for (int i = 0; i < 27; ++i) {
    const int x = i % 3, y = i / 3 % 3, z = i / 9;
    c[i] = determinantAt(p, 0.5 * x, 0.5 * y, 0.5 * z);
  }
  // From values at 0, 1/2, 1 to coefficients, along each axis.
  for (const int stride : {1, 3, 9})
    for (int i = 0; i < 27; ++i)
      if (i / stride % 3 == 1) c[i] = 2 * c[i] - 0.5 * (c[i - stride] + c[i + stride]);
  return c;
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

JacobianBounds boundsOf(const Coefficients& c) {
  JacobianBounds out{c[0], c[0]};
  for (int i = 0; i < 27; ++i) {
    out.lower = std::min(out.lower, c[i]);
    if (i % 3 != 1 && i / 3 % 3 != 1 && i / 9 != 1) out.upper = std::min(out.upper, c[i]);
  }
  return out;
}

}  // namespace

JacobianBounds leastJacobian(const Points& vertices, const Hexahedron& cell, int halvings) {
  constexpr int kOrder[8] = {0, 1, 3, 2, 4, 5, 7, 6};  // from VTK's order to that of bits
  std::array<Vec3, 8> p;
  for (int i = 0; i < 8; ++i) p[i] = vertices[cell[kOrder[i]]];
  std::vector<Coefficients> parts{coefficientsOf(p)};
  JacobianBounds out = boundsOf(parts[0]);
  double decided = out.upper;  // least lower bound of the parts that were left behind
  for (int h = 0; h < std::clamp(halvings, 0, kMostHalvings) && !out.proven() && !out.inverted();
       ++h) {
    std::vector<Coefficients> smaller;
    double lower = decided;
    for (const Coefficients& part : parts)
      for (int o = 0; o < 8 && !out.inverted(); ++o) {
        const Coefficients c = halfOf(halfOf(halfOf(part, 1, o & 1), 3, o >> 1 & 1), 9, o >> 2 & 1);
        const JacobianBounds bounds = boundsOf(c);
        out.upper = std::min(out.upper, bounds.upper);
        lower = std::min(lower, bounds.lower);
        if (bounds.proven())
          decided = std::min(decided, bounds.lower);
        else
          smaller.push_back(c);
      }
    parts = std::move(smaller);
    // Where it ended early, as the cell is inverted, the first bound is the one that holds.
    if (!out.inverted()) out.lower = lower;
  }
  return out;
}

HexahedronCheck checkHexahedra(const CellMesh& mesh, const HexahedronCheckSettings& settings) {
  if (settings.halvings < 0 || settings.halvings > kMostHalvings)
    throw SettingError("halvings", "must be from 0 to 10");
  const std::size_t count = mesh.hexahedra.size();
  std::vector<HexahedronCheck> parts((count + kCellsABlock - 1) / kCellsABlock);
  parallelBlocks(
      count, kCellsABlock,
      [&](std::size_t begin, std::size_t end) {
        HexahedronCheck& part = parts[begin / kCellsABlock];
        for (std::size_t i = begin; i < end; ++i) {
          const Hexahedron& cell = mesh.hexahedra[i];
          const JacobianBounds bounds = leastJacobian(mesh.vertices, cell, settings.halvings);
          if (bounds.proven()) continue;
          if (!bounds.inverted()) {
            ++part.undecided;
            continue;
          }
          ++part.inverted;
          for (const Tetrahedron& t : cornerTetrahedra(cell))
            if (!(signedVolume(mesh.vertices, t) > 0)) {
              ++part.invertedCorners;
              break;
            }
        }
      },
      "checking hexahedra");
  HexahedronCheck out;
  for (const HexahedronCheck& part : parts) {
    out.inverted += part.inverted;
    out.invertedCorners += part.invertedCorners;
    out.undecided += part.undecided;
  }
  return out;
}

}  // namespace innermap
