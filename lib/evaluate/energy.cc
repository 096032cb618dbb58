#include "innermap/evaluate/evaluate_map.h"

namespace innermap {

double harmonicEnergyDensity(const Mat3& jacobian) {
  double sum = 0;
  for (const auto& row : jacobian)
    for (const double x : row) sum += x * x;
  return sum;
}

double deformationEnergyDensity(const Mat3& jacobian, const LameConstants& lame) {
  double trace = 0, square = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double e = i == j ? -1 : 0;
      for (int r = 0; r < 3; ++r) e += jacobian[r][i] * jacobian[r][j];
      square += e * e;
      if (i == j) trace += e;
    }
  return 0.5 * lame.lambda * trace * trace + lame.mu * square;
}

std::vector<Setting> describe(LameConstants& s) {
  return {Setting("lame_lambda", "X", &s.lambda, "first elastic constant").from(0, 1e12).rare(),
          Setting("lame_mu", "X", &s.mu, "second elastic constant (shear)").from(0, 1e12).rare()};
}

}  // namespace innermap
