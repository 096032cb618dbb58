// Sums of point charges: the kernel of the method of fundamental solutions.
//
//   value_k(p)    = sum_j w_jk / |p - q_j|
//   gradient_k(p) = -sum_j w_jk (p - q_j) / |p - q_j|^3
//
// 1/r is 4 pi times the fundamental solution of the Laplacian in three dimensions. A source that
// coincides with the point contributes nothing. Double precision throughout: relative error of a
// few units of rounding per term. Vectorised for the best instruction set of the machine it runs
// on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"

namespace innermap {

// Charges in the layout the sums want: positions about their centre in units of their extent (so
// that neither far-away nor tiny scenes lose digits), weights beside them. Immutable, thread-safe.
class Charges {
 public:
  Charges() = default;

  // sources: #N; weights: #N x #K. Throws DataError when the sizes differ or a number is not
  // finite.
  Charges(const Points& sources, const Matrix& weights);

  std::size_t count() const { return count_; }
  std::size_t channels() const { return channels_; }

  // The same charges with the absolute values of their weights: what they could give at most.
  Charges magnitudes() const;

  // values: channel k at values[k * count + i] for points[i]. gradients may be null; its entry for
  // axis a of channel k is gradients[(3 * k + a) * count + i]. Adds to what is there. One thread.
  void addTo(const Vec3* points, std::size_t count, double* values, double* gradients) const;

 private:
  std::size_t count_ = 0, channels_ = 0;
  Vec3 center_;
  double inverseScale_ = 1;
  // One array for each group of up to three channels: x, y, z, w... per source.
  std::vector<std::vector<double>> groups_;
};

struct FieldSamples {
  Matrix values;     // #points x #K
  Matrix gradients;  // #points x 3 #K, columns 3 k + axis; empty when not asked for
  double error = 0;  // of values by fast sums: see FastSum::at; 0: plain sums
};

// Sums at many points, on all threads; the same values for any number of them. Throws Cancelled.
FieldSamples sumCharges(const Charges& charges, const Points& points, bool gradients);

// Fills `column`-major block: out[j * rowStride + i] = scale / |points[i] - sources[j]|.
// #points x #sources. On all threads. Throws Cancelled.
void fillKernelMatrix(const Points& points, const Points& sources, double scale, double* out,
                      std::size_t rowStride);

// The instruction set in use ("AVX3_ZEN4", say), for reports.
const char* instructionSet();

}  // namespace innermap
