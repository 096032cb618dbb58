#include "core/orientation.h"

#include <array>
#include <cmath>

namespace innermap {
namespace {

constexpr double kEpsilon = 0x1.0p-53;
constexpr double kBound = (7 + 56 * kEpsilon) * kEpsilon;  // Shewchuk's A of orient3d
// Products of edges no longer than this cannot overflow, and what underflows in them comes to less
// than the other: 9 errors of 2^-1074, each times an edge.
constexpr double kLongest = 0x1.0p+300, kUnderflow = 0x1.0p-760;
// Of the largest coordinate. Then all terms of the exact determinant, scaled, are multiples of
// 2^(3 (-290 - 52)): of a number that is not subnormal.
constexpr int kSmallest = -290;

double largestOf(const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

Sign signOf(double x) { return x > 0 ? Sign::positive : x < 0 ? Sign::negative : Sign::zero; }

// A sum of numbers without rounding, none of whose bits overlap, the largest last.
class Expansion {
 public:
  // Shewchuk's Grow-Expansion, without the zeros.
  void add(double x) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const double sum = x + terms_[i], part = sum - x;
      const double lost = (x - (sum - part)) + (terms_[i] - part);
      if (lost != 0) terms_[kept++] = lost;
      x = sum;
    }
    if (x != 0) terms_[kept++] = x;
    size_ = kept;
  }

  void addProduct(double x, double y, double z) {
    if (x == 0 || y == 0 || z == 0) return;
    const double xy = x * y, lost = std::fma(x, y, -xy);
    for (const double part : {lost, xy}) {
      const double p = part * z;
      add(std::fma(part, z, -p));
      add(p);
    }
  }

  Sign sign() const { return size_ == 0 ? Sign::zero : signOf(terms_[size_ - 1]); }

 private:
  // Six products of three differences of two terms each, four numbers a product of three.
  std::array<double, 6 * 8 * 4> terms_{};
  std::size_t size_ = 0;
};

// x - y = value + lost.
struct Difference {
  double value, lost;

  Difference(double x, double y) : value(x - y) {
    const double part = x - value;
    lost = (x - (value + part)) + (part - y);
  }
};

Sign exactSign(const std::array<Vec3, 4>& p) {
  double largest = 0;
  for (const Vec3& v : p) {
    if (!isFinite(v)) return Sign::undecided;
    largest = std::max(largest, largestOf(v));
  }
  if (largest == 0) return Sign::zero;
  const int exponent = std::ilogb(largest);
  std::array<std::array<double, 3>, 4> at{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = p[i][static_cast<int>(k)];
      if (x != 0 && std::ilogb(x) - exponent < kSmallest) return Sign::undecided;
      at[i][k] = std::ldexp(x, -exponent);
    }
  const auto edge = [&](std::size_t i, std::size_t k) { return Difference(at[i][k], at[0][k]); };
  Expansion sum;
  for (std::size_t k = 0; k < 3; ++k)
    for (const int sign : {1, -1}) {
      const std::size_t l = (k + (sign > 0 ? 1 : 2)) % 3, m = (k + (sign > 0 ? 2 : 1)) % 3;
      const Difference u = edge(1, k), v = edge(2, l), w = edge(3, m);
      for (const double x : {u.lost, u.value})
        for (const double y : {v.lost, v.value})
          for (const double z : {w.lost, w.value}) sum.addProduct(sign * x, y, z);
    }
  return sum.sign();
}

}  // namespace

Sign orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, std::uint64_t& exact) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  const double x1 = v.y * w.z, x2 = v.z * w.y, y1 = v.z * w.x, y2 = v.x * w.z, z1 = v.x * w.y,
               z2 = v.y * w.x;
  const double determinant = u.x * (x1 - x2) + u.y * (y1 - y2) + u.z * (z1 - z2);
  const double permanent = std::abs(u.x) * (std::abs(x1) + std::abs(x2)) +
                           std::abs(u.y) * (std::abs(y1) + std::abs(y2)) +
                           std::abs(u.z) * (std::abs(z1) + std::abs(z2));
  if (std::abs(determinant) > kBound * permanent + kUnderflow &&
      std::max({largestOf(u), largestOf(v), largestOf(w)}) < kLongest)
    return signOf(determinant);
  ++exact;
  return exactSign({a, b, c, d});
}

Sign turn(const Vec3& a, const Vec3& b, const Vec3& c, int axis, std::uint64_t& exact) {
  // det(b - a, c - a, d - a) with d above c is that component times the height.
  Vec3 d = c;
  d[axis] += largestOf(b - a) + largestOf(c - a);
  if (!(d[axis] > c[axis]))
    d[axis] = std::nextafter(c[axis], std::numeric_limits<double>::infinity());
  return orientation(a, b, c, d, exact);
}

}  // namespace innermap
