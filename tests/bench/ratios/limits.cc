#include "limits.h"

#include <cblas.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "core/random.h"
#include "innermap/core/run.h"
#include "innermap/solve/kernel_sum.h"

namespace innermap::bench {
namespace {

constexpr int kTries = 5;

// `amount` over the least seconds of some tries.
template <class Do>
double bestRate(double amount, const Do& work) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kTries; ++i) {
    Stopwatch watch;
    work();
    least = std::min(least, watch.lap());
  }
  return amount / least;
}

double copyRate(std::size_t count) {
  constexpr std::size_t kPart = std::size_t{1} << 17;
  const std::vector<double> from(count, 1.0);
  std::vector<double> to(count);
  return bestRate(2.0 * static_cast<double>(count * sizeof(double)), [&] {
    parallelBlocks(count, kPart, [&](std::size_t begin, std::size_t end) {
      std::memcpy(to.data() + begin, from.data() + begin, (end - begin) * sizeof(double));
    });
  });
}

double multiplyRate(int n, int threads) {
  const std::vector<double> a(static_cast<std::size_t>(n) * static_cast<std::size_t>(n), 0.5);
  std::vector<double> b = a, c = a;
  openblas_set_num_threads(threads);
  const double rate = bestRate(static_cast<double>(n) * n * n, [&] {
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, n, n, n, 1, a.data(), n, b.data(), n, 0,
                c.data(), n);
  });
  openblas_set_num_threads(1);  // as the library has it
  return rate;
}

double kernelRate(std::size_t blocks) {
  constexpr std::size_t kCharges = 256, kPoints = 512;
  const CounterRandom random(1, 1);
  Points charges(kCharges), points(kPoints);
  Matrix weights(kCharges, 3);
  for (std::size_t i = 0; i < 3 * kCharges; ++i) {
    charges[i / 3][static_cast<int>(i % 3)] = random.uniform(i);
    weights.data()[i] = random.uniform(i) - 0.5;
  }
  for (std::size_t i = 0; i < 3 * kPoints; ++i)
    points[i / 3][static_cast<int>(i % 3)] = 2 + random.uniform(i);
  const Charges sum(charges, weights);
  return bestRate(static_cast<double>(blocks * kCharges * kPoints), [&] {
    parallelBlocks(blocks, 1, [&](std::size_t, std::size_t) {
      std::array<double, 3 * kPoints> values{};
      std::array<double, 9 * kPoints> gradients{};
      sum.addTo(points.data(), kPoints, values.data(), gradients.data());
    });
  });
}

}  // namespace

Limits measureLimits(int threads, bool quick) {
  return {copyRate(std::size_t{1} << (quick ? 20 : 25)), multiplyRate(quick ? 256 : 2048, threads),
          kernelRate(quick ? 64 : 1024)};
}

Json asJson(const Limits& limits) {
  return {{"copied GB/s", 1e-9 * limits.copied},
          {"dgemm G multiply-adds/s", 1e-9 * limits.multiplied},
          {"kernel G pairs/s", 1e-9 * limits.summed}};
}

Json besideLimit(const Limits& limits, const Work& work, double seconds) {
  const double least = work.bytes / limits.copied + work.multiplyAdds / limits.multiplied +
                       work.pairs / limits.summed;
  return {{"limit s", least}, {"of limit %", 100 * least / seconds}};
}

}  // namespace innermap::bench
