// Small fixed-size geometry: vectors, matrices and boxes in double precision.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace innermap {

struct Vec2 {
  double x = 0, y = 0;
};

struct Vec3 {
  double x = 0, y = 0, z = 0;

  double& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  double operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
};

inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Vec3 operator*(const Vec3& a, double s) { return s * a; }
inline Vec3 operator/(const Vec3& a, double s) { return {a.x / s, a.y / s, a.z / s}; }
inline Vec3& operator+=(Vec3& a, const Vec3& b) { return a = a + b; }

inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double squaredNorm(const Vec3& a) { return dot(a, a); }
inline double norm(const Vec3& a) { return std::sqrt(dot(a, a)); }
inline bool isFinite(const Vec3& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

using Points = std::vector<Vec3>;

// Rows are stored one after the other: m[row][column].
using Mat3 = std::array<std::array<double, 3>, 3>;

inline double determinant(const Mat3& m) {
  return dot(Vec3{m[0][0], m[0][1], m[0][2]},
             cross(Vec3{m[1][0], m[1][1], m[1][2]}, Vec3{m[2][0], m[2][1], m[2][2]}));
}

inline Vec3 operator*(const Mat3& m, const Vec3& v) {
  Vec3 out;
  for (int r = 0; r < 3; ++r) out[r] = m[r][0] * v.x + m[r][1] * v.y + m[r][2] * v.z;
  return out;
}

inline Mat3 product(const Mat3& a, const Mat3& b) {
  Mat3 out{};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      out[r][c] = a[r][0] * b[0][c] + a[r][1] * b[1][c] + a[r][2] * b[2][c];
  return out;
}

inline Mat3 transposed(const Mat3& m) {
  return {{{m[0][0], m[1][0], m[2][0]}, {m[0][1], m[1][1], m[2][1]}, {m[0][2], m[1][2], m[2][2]}}};
}

// Entries that are not finite where the determinant is 0.
inline Mat3 inverse(const Mat3& m) {
  const Vec3 a{m[0][0], m[0][1], m[0][2]}, b{m[1][0], m[1][1], m[1][2]},
      c{m[2][0], m[2][1], m[2][2]};
  const Vec3 bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
  const double d = 1 / dot(a, bc);
  return {{{d * bc.x, d * ca.x, d * ab.x},
           {d * bc.y, d * ca.y, d * ab.y},
           {d * bc.z, d * ca.z, d * ab.z}}};
}

// Axis-aligned box; empty until the first point is added.
struct Box3 {
  Vec3 lower{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
             std::numeric_limits<double>::infinity()};
  Vec3 upper{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
             -std::numeric_limits<double>::infinity()};

  void add(const Vec3& p) {
    for (int a = 0; a < 3; ++a) {
      lower[a] = std::min(lower[a], p[a]);
      upper[a] = std::max(upper[a], p[a]);
    }
  }
  void add(const Box3& b) {
    add(b.lower);
    add(b.upper);
  }
  bool empty() const { return !(lower.x <= upper.x); }
  Vec3 center() const { return 0.5 * (lower + upper); }
  Vec3 extent() const { return upper - lower; }
  double diagonal() const { return empty() ? 0.0 : norm(extent()); }
};

Box3 inline boundingBox(const Points& points) {
  Box3 box;
  for (const Vec3& p : points) box.add(p);
  return box;
}

}  // namespace innermap
