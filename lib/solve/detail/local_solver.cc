#include "solve/detail/local_solver.h"

#include <cblas.h>
#include <lapacke.h>

#include <algorithm>
#include <limits>

#include "core/point_grid.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "solve/detail/blocked_qr.h"
#include "solve/detail/clusters.h"
#include "solve/detail/kernel_simd.h"

namespace innermap {
namespace {

constexpr std::size_t kClusterSize = 150;
constexpr double kWidest = 25;         // spacings; a cluster of a closed shell is 12 across
constexpr double kOverlap = 4.5;       // spacings
constexpr double kCell = 4;            // spacings, of the grids that find neighbours
constexpr double kLocalLambda = 1e-2;  // relative; strong: weaker ones converge worse

Points subset(const Points& points, const std::vector<std::size_t>& indices) {
  Points out;
  out.reserve(indices.size());
  for (const std::size_t i : indices) out.push_back(points[i]);
  return out;
}

using Floats = std::vector<float>;  // column-major

// On the calling thread: clusters are what runs side by side.
Floats kernelMatrix(const Collocation& at, const Points& sources) {
  const Points& points = at.points;
  const std::size_t rows = points.size(), padded = simd::padded(rows);
  std::vector<double> x(padded), y(padded), z(padded), column(rows);
  for (std::size_t i = 0; i < padded; ++i) {
    const Vec3& p = points[std::min(i, rows - 1)];
    x[i] = p.x;
    y[i] = p.y;
    z[i] = p.z;
  }
  Floats a;
  a.reserve(rows * sources.size());
  for (const Vec3& s : sources) {
    simd::kernelColumn(x.data(), y.data(), z.data(), rows, s.x, s.y, s.z, 1, column.data());
    fillDerivativeRows(at, {s}, column.data(), rows);
    a.insert(a.end(), column.begin(), column.end());
  }
  return a;
}

// A^T A + lambda^2 I, of which the lower triangle is filled, then factored. Single precision does
// for corrections of a residual that is summed in double; lambda is not below its rounding.
Floats choleskyOfNormalMatrix(const Floats& a, std::size_t rows, std::size_t columns) {
  const int m = static_cast<int>(rows), n = static_cast<int>(columns);
  Floats g(columns * columns);
  cblas_ssyrk(CblasColMajor, CblasLower, CblasTrans, n, m, 1, a.data(), m, 0, g.data(), n);
  double trace = 0;
  for (std::size_t j = 0; j < columns; ++j) trace += g[j * columns + j];
  const double squared =
      std::max(kLocalLambda * kLocalLambda, n * double{std::numeric_limits<float>::epsilon()});
  for (std::size_t j = 0; j < columns; ++j)
    g[j * columns + j] += static_cast<float>(squared * trace / n);
  if (LAPACKE_spotrf_work(LAPACK_COL_MAJOR, 'L', n, g.data(), n) != 0)
    throw DataError(
        "solve: a cluster's matrix is singular; the points hold NaN or infinite numbers");
  return g;
}

}  // namespace

std::uint64_t localSolverMemory(std::size_t collocation, std::size_t sources, bool refined) {
  // A cluster of 12^2 sources sees the collocation points of about (12 + 2 * 6)^2 of them. Plates,
  // needles, ears and limbs bring others close: up to 1.13 times that was measured. Where finer
  // levels stand in places only, clusters of the coarser ones see their points too.
  const std::uint64_t seen = sizeof(float) * 24 * 24 * std::max(collocation, sources);
  return refined ? 2 * seen : seen * 3 / 2;
}

void LocalSolver::add(const Points& sources, const Collocation& collocation) {
  const std::size_t before = sources_.size(), first = clusters_.size();
  sources_.insert(sources_.end(), sources.begin(), sources.end());
  for (auto& indices : clusterPoints(sources, kClusterSize, kWidest * spacing_)) {
    for (std::size_t& i : indices) i += before;
    clusters_.push_back({std::move(indices), {}, {}});
  }
  const double overlap = kOverlap * spacing_, reach = overlap + std::max(spacing_, distance_);
  const PointGrid charges(sources_, kCell * spacing_), points(collocation.points, kCell * spacing_);
  const SingleThreadedBlas guard;
  parallelBlocks(
      clusters_.size() - first, 1,
      [&](std::size_t c, std::size_t) {
        Cluster& cluster = clusters_[first + c];
        const Box3 box = boundingBox(subset(sources_, cluster.sources));
        cluster.rows = points.within(box, reach);
        if (!cluster.rows.empty()) factor(cluster, charges.within(box, overlap), collocation);
      },
      "factoring clusters");
}

void LocalSolver::factor(Cluster& cluster, const std::vector<std::size_t>& around,
                         const Collocation& collocation) const {
  const Floats a = kernelMatrix(collocation.subset(cluster.rows), subset(sources_, around));
  const std::size_t rows = cluster.rows.size(), all = around.size(), own = cluster.sources.size();
  const Floats g = choleskyOfNormalMatrix(a, rows, all);
  Floats inverse(all * own);  // own columns of G^-1
  for (std::size_t k = 0; k < own; ++k) {
    const auto at = std::lower_bound(around.begin(), around.end(), cluster.sources[k]);
    inverse[k * all + static_cast<std::size_t>(at - around.begin())] = 1;
  }
  const int m = static_cast<int>(rows), n = static_cast<int>(all), columns = static_cast<int>(own);
  LAPACKE_spotrs_work(LAPACK_COL_MAJOR, 'L', n, columns, g.data(), n, inverse.data(), n);
  cluster.solve.resize(rows * own);
  cblas_sgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, m, columns, n, 1, a.data(), m,
              inverse.data(), n, 0, cluster.solve.data(), m);
}

Matrix LocalSolver::correction(const Matrix& residual, std::size_t first) const {
  const std::size_t channels = residual.columns();
  Matrix out(sources_.size() - first, channels);
  const auto from =
      std::partition_point(clusters_.begin(), clusters_.end(),
                           [&](const Cluster& cluster) { return cluster.sources.front() < first; });
  const SingleThreadedBlas guard;
  parallelBlocks(clusters_.end() - from, 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const Cluster& cluster = from[static_cast<std::ptrdiff_t>(c)];
      const std::size_t m = cluster.rows.size(), own = cluster.sources.size();
      if (m == 0) continue;
      std::vector<float> seen(m * channels), weights(own * channels);
      for (std::size_t k = 0; k < channels; ++k)
        for (std::size_t i = 0; i < m; ++i)
          seen[k * m + i] = static_cast<float>(residual(cluster.rows[i], k));
      cblas_sgemm(CblasColMajor, CblasTrans, CblasNoTrans, static_cast<int>(own),
                  static_cast<int>(channels), static_cast<int>(m), 1, cluster.solve.data(),
                  static_cast<int>(m), seen.data(), static_cast<int>(m), 0, weights.data(),
                  static_cast<int>(own));
      for (std::size_t k = 0; k < channels; ++k)
        for (std::size_t j = 0; j < own; ++j)
          out(cluster.sources[j] - first, k) = weights[k * own + j];
    }
  });
  return out;
}

}  // namespace innermap
