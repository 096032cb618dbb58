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

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
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

// Sums of many charges at many points: a hierarchical method whose time grows as the number of
// points plus that of charges, with a stated accuracy.
//
// Same sums as kernel_sum.h. Charges in a far ball are replaced by a few proxies on a sphere; the
// potential of far charges in a ball of targets is a harmonic polynomial found from its values at a
// few points; near charges are summed exactly. Where the plain sum is cheaper it is taken.

// By cost, or one of the two for measuring.
enum class SumMethod { cheapest, direct, hierarchical };

struct FastSumSettings {
  // Root mean square error of the values of each channel, at most the larger of `accuracy` times
  // that of the values themselves, in [1e-12, 0.1], and `absolute` (in their units, not negative;
  // it never stands for more than a thousandth of the values). Gradients may be a hundred times
  // less exact, relative to theirs.
  double accuracy = 1e-6;
  double absolute = 0;
  bool gradients = false;
  SumMethod method = SumMethod::cheapest;
};

// 8 x 8 x 8 points of a lattice: point (x, y, z), x, y, z in 0..7, is at origin + spacing * (first
// + (x, y, z)), and at place 64 x + 8 y + z, as in the leaves of an OpenVDB grid.
struct LatticeBlocks {
  Vec3 origin;
  double spacing = 1;  // positive
  struct Block {
    std::array<std::int32_t, 3> first{};
    std::array<std::uint64_t, 8> wanted{};  // bit x: bit 8 y + z
  };
  std::vector<Block> blocks;
};

// values[512 * k + place], gradients[512 * (3 * k + axis) + place] (null when not asked for); zero
// or anything at places that were not wanted. Valid during the call; called from many threads.
using BlockVisitor =
    std::function<void(std::size_t block, const double* values, const double* gradients)>;

// Points at which sums of several charges are taken: what orders them is made for the first sum
// that needs it, and kept. Immutable, thread-safe; copies share their data.
class SumPoints {
 public:
  explicit SumPoints(Points points);
  const Points& points() const;

 private:
  friend class FastSum;
  struct Data;
  std::shared_ptr<const Data> data_;
};

// Immutable, thread-safe; copies share their data.
class FastSum {
 public:
  // sources: #N, fewer than 2^31; weights: #N x #K. Throws DataError as Charges does.
  FastSum(const Points& sources, const Matrix& weights);

  std::size_t count() const;
  std::size_t channels() const;
  const Charges& plain() const;  // the same charges, for plain sums

  // The accuracy is checked against plain sums at some of the points, and the order raised where it
  // does not hold. Where charges nearly cancel, so that rounding of their own sizes is more than
  // that, the most exact order is taken, and plain sums only if they are 2e9 or fewer.
  // FieldSamples::error is the largest root mean square error of a channel's values at the points
  // checked, in their units; 0 by plain sums. Same result for any number of threads. Throws
  // SettingError for a bad accuracy, DataError when a point is not finite, Cancelled.
  FieldSamples at(const SumPoints& points, const FastSumSettings& settings = {}) const;
  FieldSamples at(const Points& points, const FastSumSettings& settings = {}) const;

  // Visits each block once. Memory beyond what the visitor keeps: some kilobytes a thread and some
  // 200 bytes a block. Progress is reported as `stage`. Returns what `at` says in
  // FieldSamples::error.
  double onLattice(const LatticeBlocks& lattice, const BlockVisitor& visit,
                   const FastSumSettings& settings = {}, std::string_view stage = {}) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace innermap
