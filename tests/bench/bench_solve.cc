// Kernel sums, assembly and factorizations, beside Eigen's own QR.
#include <benchmark/benchmark.h>

#include <Eigen/QR>

#include "innermap/solve/kernel_sum.h"
#include "innermap/solve/solver.h"
#include "shapes.h"
#include "solve/detail/blocked_qr.h"

namespace innermap {
namespace {

using bench::randomMatrix;
using bench::randomPoints;

void pairsPerSecond(benchmark::State& state, double pairs) {
  state.counters["pairs/s"] = benchmark::Counter(pairs * static_cast<double>(state.iterations()),
                                                 benchmark::Counter::kIsRate);
}

void kernelSum(benchmark::State& state, bool gradients) {
  constexpr std::size_t kTargets = 20000, kSources = 5000;
  const Points targets = randomPoints(kTargets, 1);
  const Charges charges(randomPoints(kSources, 2), randomMatrix(kSources, 3, 3));
  for (auto _ : state) benchmark::DoNotOptimize(sumCharges(charges, targets, gradients));
  pairsPerSecond(state, 1.0 * kTargets * kSources);
  state.SetLabel(instructionSet());
}
BENCHMARK_CAPTURE(kernelSum, values, false)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(kernelSum, gradients, true)->UseRealTime()->Unit(benchmark::kMillisecond);

void assembly(benchmark::State& state) {
  constexpr std::size_t kRows = 8000, kColumns = 2000;
  const Points targets = randomPoints(kRows, 1), sources = randomPoints(kColumns, 2);
  Matrix a(kRows, kColumns);
  for (auto _ : state) fillKernelMatrix(targets, sources, 1, a.data(), kRows);
  pairsPerSecond(state, 1.0 * kRows * kColumns);
}
BENCHMARK(assembly)->UseRealTime()->Unit(benchmark::kMillisecond);

using bench::kColumns;
using bench::kRows;

void qrOurs(benchmark::State& state) {
  const Matrix a = randomMatrix(kRows, kColumns, 1);
  for (auto _ : state) benchmark::DoNotOptimize(BlockedQr(a).upperTriangle());
}
BENCHMARK(qrOurs)->UseRealTime()->Unit(benchmark::kMillisecond);

void qrEigen(benchmark::State& state) {
  const Matrix a = randomMatrix(kRows, kColumns, 1);
  const Eigen::MatrixXd e = Eigen::Map<const Eigen::MatrixXd>(a.data(), kRows, kColumns);
  for (auto _ : state)
    benchmark::DoNotOptimize(Eigen::HouseholderQR<Eigen::MatrixXd>(e).matrixQR());
}
BENCHMARK(qrEigen)->UseRealTime()->Unit(benchmark::kMillisecond);

// Filling, QR, SVD: all of the dense solver's set-up.
void svdOurs(benchmark::State& state) {
  const Points collocation = randomPoints(kRows, 1), sources = randomPoints(kColumns, 2);
  for (auto _ : state)
    benchmark::DoNotOptimize(DenseSolver(collocation, sources, {}).singularValues());
}
BENCHMARK(svdOurs)->UseRealTime()->Unit(benchmark::kMillisecond)->Iterations(3);

}  // namespace
}  // namespace innermap
