#include "solve/detail/lattice_block.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "solve/detail/expansion_simd.h"

namespace innermap {
namespace {

constexpr std::size_t kOctant = 64;

}  // namespace

double LatticeBlock::radius() { return 3.5 * std::sqrt(3.0); }

LatticeBlock::LatticeBlock(const SolidHarmonics& harmonics) : harmonics_(harmonics) {
  order_.resize(harmonics.count());
  std::iota(order_.begin(), order_.end(), 0);
  std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
    return harmonics.parity(a) < harmonics.parity(b);
  });
  for (const std::size_t c : order_) ++begin_[static_cast<std::size_t>(harmonics.parity(c)) + 1];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  Points points;
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y)
      for (int z = 0; z < 4; ++z) {
        const std::size_t i = points.size();
        points.push_back((1 / radius()) * Vec3{x + 0.5, y + 0.5, z + 0.5});
        for (int s = 0; s < 8; ++s) {
          const int px = s & 1 ? 3 - x : 4 + x, py = s & 2 ? 3 - y : 4 + y,
                    pz = s & 4 ? 3 - z : 4 + z;
          place_[static_cast<std::size_t>(s)][i] =
              static_cast<std::uint16_t>(64 * px + 8 * py + pz);
        }
      }
  const Matrix all = harmonics.at(points);
  octant_.resize(kOctant * order_.size());
  for (std::size_t c = 0; c < order_.size(); ++c)
    std::copy_n(all.column(order_[c]), kOctant, octant_.data() + c * kOctant);
}

void LatticeBlock::evaluateThree(const double* coefficients, double* out,
                                 std::size_t outStride) const {
  const std::size_t functions = order_.size();
  double parts[8][3][kOctant] = {};
  for (std::size_t parity = 0; parity < 8; ++parity)
    simd::multiplyThree(octant_.data() + begin_[parity] * kOctant, kOctant,
                        begin_[parity + 1] - begin_[parity], coefficients + begin_[parity],
                        functions, parts[parity][0]);
  // Hadamard transform over the parities: part s becomes the octant with the signs s.
  for (std::size_t bit = 1; bit < 8; bit *= 2)
    for (std::size_t s = 0; s < 8; ++s) {
      if (s & bit) continue;
      double *even = parts[s][0], *odd = parts[s | bit][0];
      for (std::size_t i = 0; i < 3 * kOctant; ++i) {
        const double sum = even[i] + odd[i], difference = even[i] - odd[i];
        even[i] = sum;
        odd[i] = difference;
      }
    }
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t s = 0; s < 8; ++s)
      for (std::size_t i = 0; i < kOctant; ++i) out[k * outStride + place_[s][i]] = parts[s][k][i];
}

void LatticeBlock::evaluate(const double* coefficients, std::size_t stride, double slope,
                            double* values, double* gradients) const {
  const std::size_t functions = order_.size();
  std::vector<double> sorted(3 * functions), derivative(functions);
  const auto sortInto = [&](const double* from, std::size_t k) {
    for (std::size_t c = 0; c < functions; ++c) sorted[k * functions + c] = from[order_[c]];
  };
  for (std::size_t k = 0; k < 3; ++k) sortInto(coefficients + k * stride, k);
  evaluateThree(sorted.data(), values, kPoints);
  for (int axis = 0; gradients && axis < 3; ++axis) {
    for (std::size_t k = 0; k < 3; ++k) {
      harmonics_.derivative(axis, coefficients + k * stride, derivative.data());
      for (double& c : derivative) c *= slope;
      sortInto(derivative.data(), k);
    }
    evaluateThree(sorted.data(), gradients + axis * static_cast<int>(kPoints), 3 * kPoints);
  }
}

}  // namespace innermap
