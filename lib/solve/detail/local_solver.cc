#include "solve/detail/local_solver.h"

#include <cblas.h>
#include <lapacke.h>

#include <algorithm>

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

// On the calling thread: clusters are what runs side by side.
Matrix kernelMatrix(const Collocation& at, const Points& sources) {
  const Points& points = at.points;
  const std::size_t padded = simd::padded(points.size());
  std::vector<double> x(padded), y(padded), z(padded);
  for (std::size_t i = 0; i < padded; ++i) {
    const Vec3& p = points[std::min(i, points.size() - 1)];
    x[i] = p.x;
    y[i] = p.y;
    z[i] = p.z;
  }
  Matrix a(points.size(), sources.size());
  for (std::size_t j = 0; j < sources.size(); ++j)
    simd::kernelColumn(x.data(), y.data(), z.data(), points.size(), sources[j].x, sources[j].y,
                       sources[j].z, 1, a.column(j));
  fillDerivativeRows(at, sources, a.data(), a.rows());
  return a;
}

// A^T A + lambda^2 I, of which the lower triangle is filled, then factored.
Matrix choleskyOfNormalMatrix(const Matrix& a) {
  const int m = static_cast<int>(a.rows()), n = static_cast<int>(a.columns());
  Matrix g(a.columns(), a.columns());
  cblas_dsyrk(CblasColMajor, CblasLower, CblasTrans, n, m, 1, a.data(), m, 0, g.data(), n);
  double trace = 0;
  for (std::size_t j = 0; j < g.rows(); ++j) trace += g(j, j);
  for (std::size_t j = 0; j < g.rows(); ++j)
    g(j, j) += kLocalLambda * kLocalLambda * trace / static_cast<double>(n);
  if (LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', n, g.data(), n) != 0)
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
  const Matrix a = kernelMatrix(collocation.subset(cluster.rows), subset(sources_, around));
  const Matrix g = choleskyOfNormalMatrix(a);
  const std::size_t own = cluster.sources.size();
  Matrix inverse(around.size(), own);  // own columns of G^-1
  for (std::size_t k = 0; k < own; ++k) {
    const auto at = std::lower_bound(around.begin(), around.end(), cluster.sources[k]);
    inverse(static_cast<std::size_t>(at - around.begin()), k) = 1;
  }
  const int m = static_cast<int>(a.rows()), n = static_cast<int>(a.columns()),
            columns = static_cast<int>(own);
  LAPACKE_dpotrs(LAPACK_COL_MAJOR, 'L', n, columns, g.data(), n, inverse.data(), n);
  Matrix solve(a.rows(), own);
  cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, m, columns, n, 1, a.data(), m,
              inverse.data(), n, 0, solve.data(), m);
  cluster.solve.assign(solve.data(), solve.data() + a.rows() * own);
}

Matrix LocalSolver::correction(const Matrix& residual) const {
  const std::size_t channels = residual.columns();
  Matrix out(sources_.size(), channels);
  const SingleThreadedBlas guard;
  parallelBlocks(clusters_.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const Cluster& cluster = clusters_[c];
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
        for (std::size_t j = 0; j < own; ++j) out(cluster.sources[j], k) = weights[k * own + j];
    }
  });
  return out;
}

}  // namespace innermap
