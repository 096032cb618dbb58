#include "proof/detail/direct_jet.h"

#include <cmath>

namespace innermap::proof {
namespace {

// A charge's terms are off by no more than 40 units of rounding, of 2^-53, of the magnitudes that
// are summed with them: |w| / d, |w| / d^2, 4 |w| / d^3; each of the N additions costs one more of
// the sum of the magnitudes (Higham, "Accuracy and Stability of Numerical Algorithms", 2002,
// 4.2). Units twice as large take in the rounding of the magnitudes and products of errors; the
// rest is for terms that vanish below the range of doubles.
constexpr double kUnit = 0x1p-52;
constexpr double kTerms = 64;
constexpr double kVanishing = 1e-290;
// Distances and what is made of them, up to the fifth power, stay in range.
constexpr double kNearest = 1e-50, kFarthest = 1e50;

struct Magnitudes {
  std::array<double, 3> value{}, gradient{}, hessian{};
};

class JetSum {
 public:
  JetSum(const Vec3& c, double radius) : c_(c), radius_(radius) {}

  void add(const Vec3& charge, const double weights[3]) {
    const double x = c_.x - charge.x, y = c_.y - charge.y, z = c_.z - charge.z;
    const double r = std::sqrt(x * x + y * y + z * z);
    // Of the ball; what rounding may add to the distance is taken off.
    const double gap = r * (1 - 1e-14) - radius_ * (1 + 1e-14);
    inRange_ = inRange_ && gap > kNearest && r < kFarthest;
    const double i1 = 1 / r, i2 = i1 * i1, i3 = i2 * i1, i5 = 3 * i3 * i2;
    const double g[3] = {-x * i3, -y * i3, -z * i3};
    const double h[6] = {x * x * i5 - i3, x * y * i5, x * z * i5,
                         y * y * i5 - i3, y * z * i5, z * z * i5 - i3};
    const double s2 = 1 / (gap * gap), s4 = s2 * s2;
    for (int k = 0; k < 3; ++k) {
      const double w = weights[k], size = std::abs(w);
      jet_.value[k] += w * i1;
      for (int a = 0; a < 3; ++a) jet_.gradient[k][a] += w * g[a];
      for (int i = 0; i < 6; ++i) jet_.hessian[k][i] += w * h[i];
      sizes_.value[k] += size * i1;
      sizes_.gradient[k] += size * i2;
      sizes_.hessian[k] += 4 * size * i3;
      jet_.gradientRest[k] += size * s4;
    }
  }

  void add(const Affine& affine) {
    const Vec3 d = c_ - affine.center;
    for (std::size_t k = 0; k < 3; ++k) {
      jet_.value[k] += affine.value(c_, k);
      sizes_.value[k] += std::abs(affine.coefficients(0, k));
      for (int a = 0; a < 3; ++a) {
        const double slope = affine.coefficients(1 + static_cast<std::size_t>(a), k);
        jet_.gradient[k][a] += slope;
        // The difference of the points is rounded too.
        sizes_.value[k] += 2 * std::abs(slope * d[a]);
        sizes_.gradient[k] += std::abs(slope);
      }
    }
  }

  DirectJet result(std::size_t charges) {
    const double unit = (static_cast<double>(charges) + kTerms) * kUnit;
    const double vanishing = (static_cast<double>(charges) + kTerms) * kVanishing;
    const double more = 1 + 2 * unit, square = radius_ * radius_ * more;
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      jet_.valueError[k] = unit * sizes_.value[k] + vanishing;
      jet_.gradientError[k] = unit * sizes_.gradient[k] + vanishing;
      jet_.hessianError[k] = unit * sizes_.hessian[k] + vanishing;
      const double rest = jet_.gradientRest[k] * more * square;
      jet_.valueRest[k] = rest * radius_ * more;
      jet_.gradientRest[k] = 3 * rest * more;
      sum += std::abs(jet_.value[k]) + sizes_.value[k] + sizes_.gradient[k] + sizes_.hessian[k] +
             jet_.valueRest[k] + jet_.gradientRest[k];
    }
    jet_.known = inRange_ && std::isfinite(sum);
    return jet_;
  }

 private:
  const Vec3 c_;
  const double radius_;
  bool inRange_ = true;
  DirectJet jet_;
  Magnitudes sizes_;
};

}  // namespace

DirectJet directJet(const HarmonicField& field, const Vec3& c, double radius) {
  JetSum sum(c, radius);
  const Points& sources = field.sources();
  const double* const w[3] = {field.weights().column(0), field.weights().column(1),
                              field.weights().column(2)};
  for (std::size_t j = 0; j < sources.size(); ++j) {
    const double weights[3] = {w[0][j], w[1][j], w[2][j]};
    sum.add(sources[j], weights);
  }
  sum.add(field.affine());
  return sum.result(sources.size());
}

}  // namespace innermap::proof
