#include "proof/detail/ball_expansion.h"

#include <cmath>

namespace innermap::proof {
namespace {

// Of what degree 2 does to the gradient.
constexpr double kWorthless = 0.001;

// Of what is left out of charges that are just far enough, for lower orders: there are more of
// these charges.
constexpr double kLower = 0.1;

double leftOut(int order, double ratio) {
  return std::pow(ratio, order) * (order + 1 - order * ratio) / ((1 - ratio) * (1 - ratio));
}

// The ratio at which so much is left out.
double ratioOf(int order, double share) {
  double low = 0, high = kNearRatio;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (leftOut(order, middle) < share ? low : high) = middle;
  }
  return low;
}

// Upper bounds of |L_n|.
std::array<double, kOrder + 1> degreeNorms(const StepExpansion& from) {
  std::array<double, kOrder + 1> out{};
  for (int n = 0; n <= kOrder; ++n) {
    double squares = 0;
    for (std::size_t t = termOf(n, 0); t < termOf(n + 1, 0); ++t) {
      const double* const c = from.coefficients.data() + 6 * t;
      double sum = 0;
      for (int i = 0; i < 6; ++i) sum += c[i] * c[i];
      squares += kSchmidt[t] * sum;
    }
    out[n] = std::sqrt(squares) * (1 + 1e-13);
  }
  return out;
}

}  // namespace

OrderLimits orderLimits(double farRatio) {
  OrderLimits out{1 / (farRatio * farRatio)};
  for (std::size_t i = 1; i < kOrders.size(); ++i) {
    const double ratio = ratioOf(kOrders[i], kLower * leftOut(kOrder, farRatio));
    out[i] = 1 / (ratio * ratio);
  }
  return out;
}

void sortCharges(const double* charges, const std::vector<std::uint32_t>& some,
                 const ExpansionBall& ball, const OrderLimits& limits,
                 std::vector<std::int32_t>& places, OrderedCharges& out) {
  places.resize(some.size());
  orderPlaces(charges, some.data(), some.size(), ball.center, ball.radius, limits, places.data());
  arrange(some.data(), places, out);
}

void expandAbout(const double* charges, const StepExpansion& from, int order,
                 const OrderedCharges& added, const ExpansionBall& ball, StepExpansion& out) {
  out.center = ball.center;
  out.coefficients.resize(kCoefficients);
  moveExpansion(from, order, ball.center, out.coefficients.data());
  out.remainder = from.remainder;
  out.remainder.valueMagnitude +=
      norm(ball.center - from.center) * from.remainder.gradientMagnitude;
  addCharges(charges, added, ball.radius, out);
}

int worthyOrder(const StepExpansion& from, const ExpansionBall& ball, Remainder& rest) {
  // About the expansion's own centre.
  const double radius = (norm(ball.center - from.center) + ball.radius) * (1 + 1e-13);
  const std::array<double, kOrder + 1> norms = degreeNorms(from);
  const double most = kWorthless * 2 * radius * norms[2];
  double gradient = 0, value = 0;
  int order = kOrder;
  for (; order > 2; --order) {
    const double its = norms[order] * std::pow(radius, order - 1);
    if (!(gradient + order * its <= most)) break;
    gradient += order * its;
    value += radius * its;
  }
  rest.gradient += gradient * (1 + 1e-13);
  rest.value += value * (1 + 1e-13);
  return order;
}

void addInherited(const StepExpansion& from, const Remainder& cut, const LaneSets& sets,
                  LaneRemainders& remainders) {
  const Remainder& r = from.remainder;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const Vec3 center{sets.center[0][lane], sets.center[1][lane], sets.center[2][lane]};
    remainders.gradient[lane] += r.gradient + cut.gradient;
    remainders.value[lane] += r.value + cut.value;
    remainders.gradientMagnitude[lane] += r.gradientMagnitude;
    remainders.valueMagnitude[lane] +=
        r.valueMagnitude + norm(center - from.center) * r.gradientMagnitude;
  }
}

}  // namespace innermap::proof
