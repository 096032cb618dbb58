// The innermost loops of kernel_sum.h, chosen at run time for the machine's instruction set.
#pragma once

#include <cstddef>

namespace innermap::simd {

// Terms of sums are exact to a few units of rounding (full), to 1e-7 or better (rough), or summed
// in single precision.
enum class Rounding { full, rough, single };

// `sources`: 3 + K numbers each (x, y, z, weights), K in 1..3. `x`, `y`, `z`: coordinates of
// `count` targets, readable up to the next multiple of kPadding. Writes (not adds) values[k *
// stride + i] and, when gradients is not null, gradients[(3 * k + a) * stride + i]; stride is at
// least `count` rounded up to a multiple of kRows: so far is written. Returns, with single rounding
// alone, the largest 1/distance of a pair (1e15 where they coincide, whose terms are then wrong):
// single precision tells distances apart to about 1e-7 of the largest coordinate only.
double sumCharges(const double* sources, std::size_t sourceCount, int channels, const double* x,
                  const double* y, const double* z, std::size_t count, std::size_t stride,
                  double* values, double* gradients, Rounding rounding = Rounding::full);

// out[i] = scale / |t_i - (qx, qy, qz)| for `count` targets; same padding of the inputs. Writes
// exactly `count` numbers.
void kernelColumn(const double* x, const double* y, const double* z, std::size_t count, double qx,
                  double qy, double qz, double scale, double* out);

const char* targetName();

// Targets that are read and written together at most: multiples of every vector length in use.
constexpr std::size_t kPadding = 64, kRows = 32;

// `count` rounded up to a multiple of kPadding.
inline std::size_t padded(std::size_t count) {
  return (count + kPadding - 1) / kPadding * kPadding;
}

}  // namespace innermap::simd
