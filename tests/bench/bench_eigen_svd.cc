// Eigen's SVD beside ours of bench_solve.cc. A file of its own: its templates take longest to
// compile.
#include <benchmark/benchmark.h>

#include <Eigen/SVD>

#include "innermap/solve/kernel_sum.h"
#include "shapes.h"

namespace innermap {
namespace {

using bench::kColumns;
using bench::kRows;
using bench::randomPoints;

void svdEigen(benchmark::State& state) {
  const Points collocation = randomPoints(kRows, 1), sources = randomPoints(kColumns, 2);
  for (auto _ : state) {
    Eigen::MatrixXd e(kRows, kColumns);
    fillKernelMatrix(collocation, sources, 1, e.data(), kRows);
    benchmark::DoNotOptimize(
        Eigen::BDCSVD<Eigen::MatrixXd>(e, Eigen::ComputeThinU | Eigen::ComputeThinV)
            .singularValues());
  }
}
BENCHMARK(svdEigen)->UseRealTime()->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace innermap
