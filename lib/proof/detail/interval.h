// Intervals of real numbers whose ends are rounded outward: what is computed with them holds for
// the exact numbers too. (Moore, "Interval Analysis", 1966.)
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace innermap::proof {

// Ends that are no numbers stand for "nothing is known": they pass through all operations and hold
// every number.
struct Interval {
  double lower = 0, upper = 0;

  Interval() = default;
  Interval(double exact) : lower(exact), upper(exact) {}
  Interval(double from, double to) : lower(from), upper(to) {}

  bool known() const { return lower <= upper; }
  bool positive() const { return lower > 0; }
  bool negative() const { return upper < 0; }
  // The largest absolute value; infinite where nothing is known.
  double magnitude() const {
    return known() ? std::max(std::abs(lower), std::abs(upper))
                   : std::numeric_limits<double>::infinity();
  }
};

// One floating-point operation is off by less than the way to the neighbour.
inline double below(double x) {
  return std::nextafter(x, -std::numeric_limits<double>::infinity());
}
inline double above(double x) { return std::nextafter(x, std::numeric_limits<double>::infinity()); }

inline Interval operator-(const Interval& a) { return {-a.upper, -a.lower}; }
inline Interval operator+(const Interval& a, const Interval& b) {
  return {below(a.lower + b.lower), above(a.upper + b.upper)};
}
inline Interval operator-(const Interval& a, const Interval& b) { return a + -b; }

inline Interval operator*(const Interval& a, const Interval& b) {
  const double all[4] = {a.lower * b.lower, a.lower * b.upper, a.upper * b.lower,
                         a.upper * b.upper};
  double least = all[0], most = all[0];
  for (const double x : all) {
    if (std::isnan(x)) return {x, x};
    least = std::min(least, x);
    most = std::max(most, x);
  }
  return {below(least), above(most)};
}

// All numbers where b holds 0.
inline Interval operator/(const Interval& a, const Interval& b) {
  if (!(b.lower > 0 || b.upper < 0))
    return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  return a * Interval(below(1 / b.upper), above(1 / b.lower));
}

inline Interval& operator+=(Interval& a, const Interval& b) { return a = a + b; }

// Of squares, 0 at least.
inline Interval square(const Interval& a) {
  const double most = a.magnitude();
  const double least = a.lower > 0   ? a.lower
                       : a.upper < 0 ? -a.upper
                       : a.known()   ? 0
                                     : std::nan("");
  return {std::max(0.0, below(least * least)), above(most * most)};
}

// Of numbers that are not below 0.
inline Interval squareRoot(const Interval& a) {
  return {std::max(0.0, below(std::sqrt(std::max(0.0, a.lower)))), above(std::sqrt(a.upper))};
}

// All numbers within `radius` of 0.
inline Interval within(double radius) { return {-radius, radius}; }

}  // namespace innermap::proof
