#include "surface/detail/topology/knot.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/random.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr std::uint64_t kPrime = (std::uint64_t{1} << 61) - 1;

std::uint64_t multiply(std::uint64_t a, std::uint64_t b) {
  __extension__ typedef unsigned __int128 Wide;
  return static_cast<std::uint64_t>(static_cast<Wide>(a) * b % kPrime);
}
std::uint64_t add(std::uint64_t a, std::uint64_t b) { return (a + b) % kPrime; }
std::uint64_t negative(std::uint64_t a) { return a == 0 ? 0 : kPrime - a; }
std::uint64_t power(std::uint64_t a, std::uint64_t n) {
  std::uint64_t out = 1;
  for (; n; n >>= 1, a = multiply(a, a))
    if (n & 1) out = multiply(out, a);
  return out;
}

bool crosses(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p, const Vec3& q) {
  const Vec3 n = cross(b - a, c - a);
  const double sp = dot(n, p - a), sq = dot(n, q - a);
  if ((sp > 0) == (sq > 0)) return false;
  const Vec3 d = q - p;
  const double x = dot(d, cross(a - p, b - p)), y = dot(d, cross(b - p, c - p)),
               z = dot(d, cross(c - p, a - p));
  return ((x > 0) == (y > 0)) && ((y > 0) == (z > 0));
}

// Takes out corners as long as the triangles that go with them are empty.
void shrink(Points& polygon) {
  for (bool changed = true; changed && polygon.size() > 3;) {
    changed = false;
    for (std::size_t i = 0; i < polygon.size() && polygon.size() > 3;) {
      throwIfCancelled();
      const std::size_t n = polygon.size(), before = (i + n - 1) % n, after = (i + 1) % n;
      bool empty = true;
      for (std::size_t j = (after + 1) % n; j != before && empty; j = (j + 1) % n) {
        const std::size_t k = (j + 1) % n;
        empty = k == before ||
                !crosses(polygon[before], polygon[i], polygon[after], polygon[j], polygon[k]);
      }
      if (empty) {
        polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(i));
        changed = true;
      } else {
        ++i;
      }
    }
  }
}

struct Crossing {
  double at;    // along the polygon, where it passes below
  double over;  // and above
  bool positive;
};

std::vector<Crossing> crossingsOf(const Points& p) {
  std::vector<Crossing> out;
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j + 1 == n) continue;
      const Vec3 &a = p[i], &b = p[i + 1], &c = p[j], &d = p[(j + 1) % n];
      const double ux = b.x - a.x, uy = b.y - a.y, vx = d.x - c.x, vy = d.y - c.y;
      const double det = ux * vy - uy * vx;
      const double s = ((c.x - a.x) * vy - (c.y - a.y) * vx) / det,
                   t = ((c.x - a.x) * uy - (c.y - a.y) * ux) / det;
      if (!(s >= 0 && s < 1 && t >= 0 && t < 1)) continue;
      const bool firstOver = a.z + s * (b.z - a.z) > c.z + t * (d.z - c.z);
      const double x = static_cast<double>(i) + s, y = static_cast<double>(j) + t;
      out.push_back({firstOver ? y : x, firstOver ? x : y, (det > 0) == firstOver});
    }
  }
  std::sort(out.begin(), out.end(),
            [](const Crossing& a, const Crossing& b) { return a.at < b.at; });
  return out;
}

// Determinant modulo the prime.
std::uint64_t determinant(std::vector<std::vector<std::uint64_t>> m) {
  std::uint64_t det = 1;
  const std::size_t n = m.size();
  for (std::size_t c = 0; c < n; ++c) {
    std::size_t pivot = c;
    while (pivot < n && m[pivot][c] == 0) ++pivot;
    if (pivot == n) return 0;
    if (pivot != c) {
      std::swap(m[pivot], m[c]);
      det = negative(det);
    }
    det = multiply(det, m[c][c]);
    const std::uint64_t inverse = power(m[c][c], kPrime - 2);
    for (std::size_t r = c + 1; r < n; ++r) {
      const std::uint64_t f = negative(multiply(m[r][c], inverse));
      if (f == 0) continue;
      for (std::size_t k = c; k < n; ++k) m[r][k] = add(m[r][k], multiply(f, m[c][k]));
    }
  }
  return det;
}

// The Alexander polynomial at t, but for a power of t and the sign: a minor of the matrix whose
// rows are the crossings and whose columns are the arcs between passages below.
std::uint64_t alexander(const std::vector<Crossing>& crossings, std::uint64_t t) {
  const std::size_t n = crossings.size();
  std::vector<std::vector<std::uint64_t>> m(n, std::vector<std::uint64_t>(n, 0));
  for (std::size_t i = 0; i < n; ++i) {
    const auto arc = std::upper_bound(crossings.begin(), crossings.end(), crossings[i].over,
                                      [](double x, const Crossing& c) { return x < c.at; });
    const std::size_t over = static_cast<std::size_t>(arc - crossings.begin()) % n;
    std::size_t in = i, out = (i + 1) % n;
    if (!crossings[i].positive) std::swap(in, out);
    m[i][over] = add(m[i][over], add(1, negative(t)));
    m[i][in] = add(m[i][in], t);
    m[i][out] = add(m[i][out], kPrime - 1);
  }
  m.pop_back();
  for (auto& row : m) row.pop_back();
  return determinant(std::move(m));
}

}  // namespace

bool isKnotted(const Points& polygon) {
  // In general position: nothing coplanar, no crossing above a corner.
  Points points = polygon;
  const double size = boundingBox(polygon).diagonal();
  const CounterRandom random(1, 0x6b6e6f74);
  std::uint64_t drawn = 0;
  const Mat3 turn = {{{0.36, 0.48, -0.8}, {-0.8, 0.6, 0}, {0.48, 0.64, 0.6}}};
  for (Vec3& p : points) {
    for (int axis = 0; axis < 3; ++axis) p[axis] += 1e-10 * size * (random.uniform(drawn++) - 0.5);
    p = turn * p;
  }
  shrink(points);
  if (points.size() <= 5) return false;  // knots have six sides or more
  const std::vector<Crossing> crossings = crossingsOf(points);
  if (crossings.size() < 3) return false;
  // A trivial polynomial is plus or minus a power of t.
  const std::uint64_t t = random.bits(drawn) % kPrime, value = alexander(crossings, t);
  std::uint64_t unit = 1;
  for (std::size_t k = 0; k <= crossings.size(); ++k, unit = multiply(unit, t))
    if (value == unit || value == negative(unit)) return false;
  return true;
}

}  // namespace innermap
