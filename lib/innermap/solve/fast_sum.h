// Sums of many charges at many points: a hierarchical method whose time grows as the number of
// points plus that of charges, with a stated accuracy.
//
// Same sums as kernel_sum.h. Charges in a far ball are replaced by a few proxies on a sphere; the
// potential of far charges in a ball of targets is a harmonic polynomial found from its values at a
// few points; near charges are summed exactly. Where the plain sum is cheaper it is taken.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"
#include "innermap/solve/kernel_sum.h"

namespace innermap {

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
