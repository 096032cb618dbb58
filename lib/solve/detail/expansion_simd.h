// The innermost loops of expansions, chosen at run time for the machine's
// instruction set.
#pragma once

#include <cstddef>

#include "solve/detail/kernel_simd.h"

namespace innermap::simd {

// SolidHarmonics::fill; `recurrence`: two factors for each (m, n).
void solidHarmonics(int order, const double* recurrence, const double* x, const double* y,
                    const double* z, std::size_t points, double* out, std::size_t stride);

// y[k * rows + i] += sum_j a[j * rows + i] x[k * xStride + j] for k = 0, 1, 2 and j < columns.
// rows: a multiple of kRows.
void multiplyThree(const double* a, std::size_t rows, std::size_t columns, const double* x,
                   std::size_t xStride, double* y);

}  // namespace innermap::simd
