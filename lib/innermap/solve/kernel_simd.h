// The innermost loops of kernel_sum.h, chosen at run time for the machine's instruction set.
#pragma once

#include <cstddef>

namespace innermap::simd {

// `sources`: 3 + K numbers each (x, y, z, weights), K in 1..3. `x`, `y`, `z`: coordinates of
// `count` targets, readable up to the next multiple of kPadding. Writes (not adds) values[k *
// stride + i] and, when gradients is not null, gradients[(3 * k + a) * stride + i]; stride is at
// least `count` rounded up to a multiple of kRows: so far is written. Terms are exact to a few
// units of rounding (full), to 1e-7 or better (rough), or summed in single precision where there
// are no gradients (single; rough with them).
enum class Rounding { full, rough, single };
void sumCharges(const double* sources, std::size_t sourceCount, int channels, const double* x,
                const double* y, const double* z, std::size_t count, std::size_t stride,
                double* values, double* gradients, Rounding rounding = Rounding::full);

// out[i] = scale / |t_i - (qx, qy, qz)| for `count` targets; same padding of the inputs. Writes
// exactly `count` numbers.
void kernelColumn(const double* x, const double* y, const double* z, std::size_t count, double qx,
                  double qy, double qz, double scale, double* out);

const char* targetName();

// Targets that are read and written together at most: multiples of every vector length in use.
constexpr std::size_t kPadding = 64, kRows = 32;

}  // namespace innermap::simd
