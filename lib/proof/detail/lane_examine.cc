#include <limits>

#include "proof/detail/lane_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "proof/detail/lane_examine.cc"
#include "hwy/foreach_target.h"  // compiles this file once for each instruction set
#include "proof/detail/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace innermap::proof {
namespace HWY_NAMESPACE {
// NOLINTBEGIN(readability-identifier-naming): named like the functions of Highway.

// Symmetric: xx, xy, xz, yy, yz, zz.
struct Symmetric {
  V m[6];
};
struct Matrix3 {
  V m[3][3];
};

HWY_INLINE Symmetric Square(const Symmetric& s) {
  const V xx = s.m[0], xy = s.m[1], xz = s.m[2], yy = s.m[3], yz = s.m[4], zz = s.m[5];
  return {{xx * xx + xy * xy + xz * xz, xx * xy + xy * yy + xz * yz, xx * xz + xy * yz + xz * zz,
           xy * xy + yy * yy + yz * yz, xy * xz + yy * yz + yz * zz, xz * xz + yz * yz + zz * zz}};
}

// Of the fourth powers of the eigenvalues the sum: the greatest eigenvalue is at most its fourth
// root, which is at most 1.32 times as large.
HWY_INLINE V FourthPowers(const Symmetric& s) {
  const Symmetric q = Square(s);
  const V off = q.m[1] * q.m[1] + q.m[2] * q.m[2] + q.m[4] * q.m[4];
  return q.m[0] * q.m[0] + q.m[3] * q.m[3] + q.m[5] * q.m[5] + off + off;
}

// m m^T
HWY_INLINE Symmetric Gram(const Matrix3& a) {
  Symmetric out;
  int place = 0;
  for (int r = 0; r < 3; ++r)
    for (int s = r; s < 3; ++s)
      out.m[place++] = a.m[r][0] * a.m[s][0] + a.m[r][1] * a.m[s][1] + a.m[r][2] * a.m[s][2];
  return out;
}

// b s b^T
HWY_INLINE Symmetric Between(const Matrix3& b, const Symmetric& s) {
  const V full[3][3] = {
      {s.m[0], s.m[1], s.m[2]}, {s.m[1], s.m[3], s.m[4]}, {s.m[2], s.m[4], s.m[5]}};
  Matrix3 half;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      half.m[r][c] = b.m[r][0] * full[0][c] + b.m[r][1] * full[1][c] + b.m[r][2] * full[2][c];
  Symmetric out;
  int place = 0;
  for (int r = 0; r < 3; ++r)
    for (int c = r; c < 3; ++c)
      out.m[place++] =
          half.m[r][0] * b.m[c][0] + half.m[r][1] * b.m[c][1] + half.m[r][2] * b.m[c][2];
  return out;
}

HWY_INLINE V EighthRoot(V x) { return hn::Sqrt(hn::Sqrt(hn::Sqrt(x))); }

// Upper bounds of spectral norms: of a matrix, and of one whose Gram matrix is given.
HWY_INLINE V NormOfGram(const Symmetric& s) { return EighthRoot(FourthPowers(s)); }
HWY_INLINE V Norm(const Matrix3& a) { return NormOfGram(Gram(a)); }

HWY_INLINE V Determinant(const Matrix3& a) {
  return a.m[0][0] * (a.m[1][1] * a.m[2][2] - a.m[1][2] * a.m[2][1]) +
         a.m[0][1] * (a.m[1][2] * a.m[2][0] - a.m[1][0] * a.m[2][2]) +
         a.m[0][2] * (a.m[1][0] * a.m[2][1] - a.m[1][1] * a.m[2][0]);
}

HWY_INLINE Matrix3 Inverse(const Matrix3& a, V determinant) {
  const V scale = Number(1) / determinant;
  Matrix3 out;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) {
      const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
      out.m[c][r] = scale * (a.m[r1][c1] * a.m[r2][c2] - a.m[r1][c2] * a.m[r2][c1]);
    }
  return out;
}

HWY_INLINE V CoefficientOf(const double* coefficients, int n, int m, int channel, int part) {
  return hn::Load(D(), coefficients + (6 * termOf(n, m) + 2 * channel + part) * Side());
}

// The gradients of the channels at the centre, one a row.
HWY_INLINE Matrix3 Derivative(const double* coefficients) {
  Matrix3 out;
  for (int k = 0; k < 3; ++k) {
    out.m[k][0] = CoefficientOf(coefficients, 1, 1, k, 0);
    out.m[k][1] = CoefficientOf(coefficients, 1, 1, k, 1);
    out.m[k][2] = CoefficientOf(coefficients, 1, 0, k, 0);
  }
  return out;
}

// Second derivatives of a channel.
HWY_INLINE Symmetric Hessian(const double* coefficients, int channel) {
  const V half = Number(0.5);
  const V zz = CoefficientOf(coefficients, 2, 0, channel, 0);
  const V a = half * CoefficientOf(coefficients, 2, 2, channel, 0);
  return {{a - half * zz, half * CoefficientOf(coefficients, 2, 2, channel, 1),
           CoefficientOf(coefficients, 2, 1, channel, 0), hn::Neg(a) - half * zz,
           CoefficientOf(coefficients, 2, 1, channel, 1), zz}};
}

// L_n L_n^T of the coefficients of degree n in the basis of Schmidt: for one charge of weight w at
// distance d its largest eigenvalue is (|w| / d^(n+1))^2.
HWY_INLINE Symmetric DegreeGram(const double* coefficients, int n) {
  const D d;
  Symmetric out;
  for (V& v : out.m) v = hn::Zero(d);
  for (int m = 0; m <= n; ++m) {
    const V scale = Number(kSchmidt[termOf(n, m)]);
    for (int part = 0; part < (m == 0 ? 1 : 2); ++part) {
      V c[3];
      for (int k = 0; k < 3; ++k) c[k] = CoefficientOf(coefficients, n, m, k, part);
      int place = 0;
      for (int r = 0; r < 3; ++r) {
        const V scaled = scale * c[r];
        for (int s = r; s < 3; ++s, ++place) out.m[place] = hn::MulAdd(scaled, c[s], out.m[place]);
      }
    }
  }
  return out;
}

// max over the vertices of |B H(v)|, B times what the second derivatives add to the first ones.
HWY_INLINE V QuadraticPart(const Matrix3& b, const double* coefficients, const LaneSets& sets,
                           std::size_t lane) {
  const D d;
  Symmetric turned[3];
  for (Symmetric& s : turned)
    for (V& v : s.m) v = hn::Zero(d);
  for (int k = 0; k < 3; ++k) {
    const Symmetric h = Hessian(coefficients, k);
    for (int r = 0; r < 3; ++r)
      for (int i = 0; i < 6; ++i) turned[r].m[i] = hn::MulAdd(b.m[r][k], h.m[i], turned[r].m[i]);
  }
  V most = hn::Zero(d);
  for (const auto& vertex : sets.vertex) {
    const V x = hn::Load(d, vertex[0] + lane), y = hn::Load(d, vertex[1] + lane),
            z = hn::Load(d, vertex[2] + lane);
    Matrix3 e;
    for (int r = 0; r < 3; ++r) {
      const V* const s = turned[r].m;
      e.m[r][0] = s[0] * x + s[1] * y + s[2] * z;
      e.m[r][1] = s[1] * x + s[3] * y + s[4] * z;
      e.m[r][2] = s[2] * x + s[4] * y + s[5] * z;
    }
    most = hn::Max(most, FourthPowers(Gram(e)));
  }
  return EighthRoot(most);
}

HWY_INLINE V DistanceFromUnit(const Matrix3& b, const Matrix3& j) {
  V sum = hn::Zero(D());
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) {
      const V e = b.m[r][0] * j.m[0][c] + b.m[r][1] * j.m[1][c] + b.m[r][2] * j.m[2][c] -
                  Number(r == c ? 1 : 0);
      sum = hn::MulAdd(e, e, sum);
    }
  return hn::Sqrt(sum);
}

// Of terms whose absolute values sum to 1: what may come of rounding them and of moving their sum
// through 26 levels, 9,000 units of rounding; derived in docs/method.md, "Rounding". For the sums
// over charges see FieldTree::rounding().
constexpr double kRounding = 1e-12;
constexpr double kRelative = 1e-14;  // of a few operations

// The image of the sets: f is its linear part at the centre plus the rest, which is no larger than
// `rest`.
HWY_INLINE void Enclose(const double* coefficients, const Matrix3& j, V rest, const LaneSets& sets,
                        std::size_t lane, LaneSets& image) {
  const D d;
  V center = hn::Zero(d);
  for (int k = 0; k < 3; ++k) {
    const V value = CoefficientOf(coefficients, 0, 0, k, 0);
    hn::Store(value, d, image.center[k] + lane);
    center = hn::Max(center, hn::Abs(value));
  }
  V radius = hn::Zero(d);
  for (int i = 0; i < 4; ++i) {
    V square = hn::Zero(d);
    for (int k = 0; k < 3; ++k) {
      const V moved = j.m[k][0] * hn::Load(d, sets.vertex[i][0] + lane) +
                      j.m[k][1] * hn::Load(d, sets.vertex[i][1] + lane) +
                      j.m[k][2] * hn::Load(d, sets.vertex[i][2] + lane);
      hn::Store(moved, d, image.vertex[i][k] + lane);
      square = hn::MulAdd(moved, moved, square);
    }
    radius = hn::Max(radius, square);
  }
  radius = hn::Sqrt(radius);
  const V slack = rest + Number(kRelative) * (center + radius);
  hn::Store(slack, d, image.slack + lane);
  hn::Store((radius + slack) * Number(1 + kRelative), d, image.radius + lane);
}

HWY_INLINE void ExamineLanes(const double* all, const LaneRemainders& remainders,
                             const LaneSets& sets, std::size_t lane, LaneFindings& out) {
  const D d;
  const double* const coefficients = all + lane * kCoefficients;
  const Matrix3 j = Derivative(coefficients);
  const V determinant = Determinant(j);
  const Matrix3 b = Inverse(j, determinant);
  const V inverseNorm = Norm(b), norm = Norm(j);
  const V radius = hn::Load(d, sets.radius + lane), slack = hn::Load(d, sets.slack + lane);
  V excess = QuadraticPart(b, coefficients, sets, lane) + DistanceFromUnit(b, j);
  V rest = norm * slack;
  V power = radius;  // radius^(n-1)
  for (int n = 2; n <= kOrder; ++n) {
    Symmetric gram = DegreeGram(coefficients, n);
    const V square = power * power;
    for (V& v : gram.m) v = v * square;
    const V turned = NormOfGram(Between(b, gram)) * Number(n);
    // Degree 2 is known at the vertices; the ball about them adds to it.
    excess = excess + (n == 2 ? turned * (slack / radius) : turned);
    rest = rest + NormOfGram(gram) * radius;
    power = power * radius;
  }
  const V cut = hn::Load(d, remainders.gradient + lane) +
                Number(kRounding) * hn::Load(d, remainders.gradientMagnitude + lane);
  excess = excess + inverseNorm * cut;
  rest = rest + hn::Load(d, remainders.value + lane) +
         Number(kRounding) * hn::Load(d, remainders.valueMagnitude + lane);
  // Below that, rounding might have turned the sign.
  const auto sure = hn::Gt(hn::Abs(determinant), Number(1e-12) * norm * norm * norm);
  excess = hn::IfThenElse(sure, excess, Number(std::numeric_limits<double>::infinity()));
  const V left = hn::Max(hn::Zero(d), Number(1 - 1e-9) - excess);
  hn::Store(excess, d, out.excess + lane);
  hn::Store(determinant, d, out.determinant + lane);
  hn::Store(hn::Abs(determinant) * left * left * left, d, out.least + lane);
  Enclose(coefficients, j, rest, sets, lane, out.image);
}

void Examine(const double* HWY_RESTRICT coefficients, const LaneRemainders& remainders,
             const LaneSets& sets, LaneFindings& out) {
  for (std::size_t lane = 0; lane < kLanes; lane += Side())
    ExamineLanes(coefficients, remainders, sets, lane, out);
}

// NOLINTEND(readability-identifier-naming)
}  // namespace HWY_NAMESPACE
}  // namespace innermap::proof
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace innermap::proof {

HWY_EXPORT(Examine);

void examine(const double* coefficients, const LaneRemainders& remainders, const LaneSets& sets,
             LaneFindings& out) {
  HWY_DYNAMIC_DISPATCH(Examine)(coefficients, remainders, sets, out);
}

}  // namespace innermap::proof
#endif
