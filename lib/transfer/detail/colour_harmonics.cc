#include "transfer/detail/colour_harmonics.h"

#include <array>
#include <cmath>
#include <utility>

namespace innermap {
namespace {

// What a harmonic of degree l is in 2 l + 1 directions determines it. These were searched for among
// small whole numbers, of any length since harmonics are homogeneous: conditions are 1, 2.9
// and 4.1.
constexpr int kMost = 2 * kHarmonicDegrees + 1;
constexpr int kDirections[kHarmonicDegrees][kMost][3] = {
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
    {{0, 1, 1}, {1, -1, 0}, {0, 1, -1}, {1, 0, 1}, {1, 1, 0}},
    {{1, 1, -1}, {1, -1, -1}, {1, -1, 1}, {1, 1, 1}, {1, 1, 0}, {1, 0, 1}, {0, 1, -1}}};

using Square = std::array<std::array<double, kMost>, kMost>;

Vec3 sampleOf(int degree, int i) {
  const int* s = kDirections[degree - 1][i];
  return {static_cast<double>(s[0]), static_cast<double>(s[1]), static_cast<double>(s[2])};
}

// By Gauss and Jordan, with pivots.
Square inverted(Square m, int size) {
  Square out{};
  for (int i = 0; i < size; ++i) out[i][i] = 1;
  for (int k = 0; k < size; ++k) {
    int pivot = k;
    for (int r = k + 1; r < size; ++r)
      if (std::abs(m[r][k]) > std::abs(m[pivot][k])) pivot = r;
    std::swap(m[k], m[pivot]);
    std::swap(out[k], out[pivot]);
    const double by = 1 / m[k][k];
    for (int c = 0; c < size; ++c) {
      m[k][c] *= by;
      out[k][c] *= by;
    }
    for (int r = 0; r < size; ++r) {
      const double factor = r == k ? 0 : m[r][k];
      for (int c = 0; c < size; ++c) {
        m[r][c] -= factor * m[k][c];
        out[r][c] -= factor * out[k][c];
      }
    }
  }
  return out;
}

// Coefficients from values at the samples, by degree.
std::array<Square, kHarmonicDegrees> solvers() {
  std::array<Square, kHarmonicDegrees> out;
  for (int degree = 1; degree <= kHarmonicDegrees; ++degree) {
    Square values{};
    for (int i = 0; i < 2 * degree + 1; ++i)
      evaluateHarmonics(degree, sampleOf(degree, i), values[i].data());
    out[degree - 1] = inverted(values, 2 * degree + 1);
  }
  return out;
}

}  // namespace

// As the reference implementation has them.
void evaluateHarmonics(int degree, const Vec3& d, double* out) {
  const double x = d.x, y = d.y, z = d.z, xx = x * x, yy = y * y, zz = z * z;
  if (degree == 1) {
    constexpr double kFirst = 0.4886025119029199;
    out[0] = -kFirst * y;
    out[1] = kFirst * z;
    out[2] = -kFirst * x;
  } else if (degree == 2) {
    constexpr double kSecond[3] = {1.0925484305920792, 0.31539156525252005, 0.5462742152960396};
    out[0] = kSecond[0] * x * y;
    out[1] = -kSecond[0] * y * z;
    out[2] = kSecond[1] * (2 * zz - xx - yy);
    out[3] = -kSecond[0] * x * z;
    out[4] = kSecond[2] * (xx - yy);
  } else {
    constexpr double kThird[5] = {0.5900435899266435, 2.890611442640554, 0.4570457994644658,
                                  0.3731763325901154, 1.445305721320277};
    out[0] = -kThird[0] * y * (3 * xx - yy);
    out[1] = kThird[1] * x * y * z;
    out[2] = -kThird[2] * y * (4 * zz - xx - yy);
    out[3] = kThird[3] * z * (2 * zz - 3 * xx - 3 * yy);
    out[4] = -kThird[2] * x * (4 * zz - xx - yy);
    out[5] = kThird[4] * z * (xx - yy);
    out[6] = -kThird[0] * x * (xx - 3 * yy);
  }
}

HarmonicTurn::HarmonicTurn(const Mat3& orthogonal, int degree) : degree_(degree) {
  static const std::array<Square, kHarmonicDegrees> solve = solvers();
  // Turned colours at d are those that were at R^T d.
  const Mat3 back = transposed(orthogonal);
  double* to = matrices_;
  for (int l = 1; l <= degree; ++l) {
    const int size = 2 * l + 1;
    double values[kMost][kMost];
    for (int i = 0; i < size; ++i) evaluateHarmonics(l, back * sampleOf(l, i), values[i]);
    for (int r = 0; r < size; ++r)
      for (int c = 0; c < size; ++c) {
        double sum = 0;
        for (int i = 0; i < size; ++i) sum += solve[l - 1][r][i] * values[i][c];
        *to++ = sum;
      }
  }
}

void HarmonicTurn::turn(double* coefficients) const {
  const double* from = matrices_;
  for (int l = 1; l <= degree_; ++l) {
    const int size = 2 * l + 1;
    double turned[kMost] = {};
    for (int r = 0; r < size; ++r)
      for (int c = 0; c < size; ++c) turned[r] += *from++ * coefficients[c];
    for (int r = 0; r < size; ++r) coefficients[r] = turned[r];
    coefficients += size;
  }
}

}  // namespace innermap
