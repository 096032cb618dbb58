#include <fmt/format.h>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/tetra/compare_fem.h"

namespace innermap {
namespace {

constexpr char kSolving[] = "solving finite elements";

using Sparse = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
using Factor = Eigen::IncompleteCholesky<double, Eigen::Lower, Eigen::AMDOrdering<int>>;

class Solver {
 public:
  Solver(const CellMesh& mesh, const Matrix& boundaryValues, const HarmonicCellsSettings& settings)
      : mesh_(mesh), given_(boundaryValues), settings_(settings) {
    number();
    assemble();
  }

  HarmonicCells run() {
    HarmonicCells result;
    result.values = Matrix(mesh_.vertices.size(), given_.columns());
    result.unknowns = static_cast<std::size_t>(matrix_.cols());
    for (std::size_t v = 0; v < mesh_.vertices.size(); ++v)
      for (std::size_t k = 0; k < given_.columns() && fixed_[v]; ++k)
        result.values(v, k) = given_(v, k);
    if (result.unknowns == 0) return result;
    throwIfCancelled();
    Factor factor(matrix_);
    if (factor.info() != Eigen::Success)
      throw DataError(mesh_.name + ": the finite elements' matrix cannot be factored");
    std::vector<int> iterations(given_.columns());
    std::vector<double> residuals(given_.columns());
    parallelBlocks(given_.columns(), 1, [&](std::size_t k, std::size_t) {
      Eigen::VectorXd x = startOf(k);
      residuals[k] =
          conjugateGradients(factor, right_.col(static_cast<Eigen::Index>(k)), x, iterations[k]);
      for (std::size_t v = 0; v < mesh_.vertices.size(); ++v)
        if (unknown_[v] >= 0) result.values(v, k) = x[unknown_[v]];
    });
    result.iterations = *std::max_element(iterations.begin(), iterations.end());
    result.residual = *std::max_element(residuals.begin(), residuals.end());
    if (!(result.residual <= settings_.residual))
      throw DataError(
          fmt::format("{}: conjugate gradients reached a residual of {:.2g} after {} iterations "
                      "instead of {:.2g}",
                      mesh_.name, result.residual, result.iterations, settings_.residual));
    return result;
  }

 private:
  void number() {
    fixed_ = boundaryVertices(mesh_);
    std::vector<bool> used(mesh_.vertices.size(), false);
    for (const Tetrahedron& t : mesh_.tetrahedra)
      for (const int v : t) used[v] = true;
    unknown_.assign(mesh_.vertices.size(), -1);
    int next = 0;
    for (std::size_t v = 0; v < used.size(); ++v)
      if (used[v] && !fixed_[v]) unknown_[v] = next++;
    matrix_.resize(next, next);
    right_ = Eigen::MatrixXd::Zero(next, static_cast<Eigen::Index>(given_.columns()));
  }

  // Only the lower triangle: it is symmetric.
  void assemble() {
    std::vector<Eigen::Triplet<double, int>> entries;
    entries.reserve(10 * mesh_.tetrahedra.size());
    for (std::size_t t = 0; t < mesh_.tetrahedra.size(); ++t) {
      if (t % 65536 == 0) throwIfCancelled();
      const Tetrahedron& c = mesh_.tetrahedra[t];
      const double volume = signedVolume(mesh_.vertices, c);
      if (!(volume > 0))
        throw DataError(fmt::format("{}: tetrahedron {} (counted from 0) has no positive volume",
                                    mesh_.name, t));
      const std::array<Vec3, 4> g = cornerGradients(mesh_.vertices, c);
      for (int i = 0; i < 4; ++i) {
        const int row = unknown_[c[i]];
        if (row < 0) continue;
        for (int j = 0; j < 4; ++j) {
          const double stiffness = volume * dot(g[i], g[j]);
          const int column = unknown_[c[j]];
          if (column < 0)
            for (std::size_t k = 0; k < given_.columns(); ++k)
              right_(row, static_cast<Eigen::Index>(k)) -= stiffness * given_(c[j], k);
          else if (row >= column)
            entries.emplace_back(row, column, stiffness);
        }
      }
    }
    matrix_.setFromTriplets(entries.begin(), entries.end());
  }

  // The mean of the boundary's values.
  Eigen::VectorXd startOf(std::size_t channel) const {
    double sum = 0, count = 0;
    for (std::size_t v = 0; v < fixed_.size(); ++v)
      if (fixed_[v]) {
        sum += given_(v, channel);
        ++count;
      }
    return Eigen::VectorXd::Constant(matrix_.cols(), count > 0 ? sum / count : 0);
  }

  // Eigen's own cannot be cancelled. Returns the residual relative to the right side's.
  double conjugateGradients(const Factor& factor, const Eigen::VectorXd& b, Eigen::VectorXd& x,
                            int& iterations) const {
    const auto times = [&](const Eigen::VectorXd& v) -> Eigen::VectorXd {
      return matrix_.selfadjointView<Eigen::Lower>() * v;
    };
    const double norm = b.norm();
    if (!(norm > 0)) {
      x.setZero();
      return 0;
    }
    Eigen::VectorXd residual = b - times(x), z = factor.solve(residual), direction = z;
    double rz = residual.dot(z);
    for (iterations = 0;
         residual.norm() > settings_.residual * norm && iterations < settings_.maxIterations;
         ++iterations) {
      const Eigen::VectorXd applied = times(direction);
      const double step = rz / direction.dot(applied);
      x += step * direction;
      residual -= step * applied;
      z = factor.solve(residual);
      const double next = residual.dot(z);
      direction = z + next / rz * direction;
      rz = next;
      reportProgress(
          kSolving,
          std::clamp(std::log(residual.norm() / norm) / std::log(settings_.residual), 0.0, 1.0));
    }
    return residual.norm() / norm;
  }

  const CellMesh& mesh_;
  const Matrix& given_;
  const HarmonicCellsSettings& settings_;
  std::vector<bool> fixed_;
  std::vector<int> unknown_;  // -1: known, or of no tetrahedron
  Sparse matrix_;
  Eigen::MatrixXd right_;
};

}  // namespace

std::vector<bool> boundaryVertices(const CellMesh& mesh) {
  std::vector<bool> on(mesh.vertices.size(), false);
  for (const Triangle& t : boundaryTriangles(mesh))
    for (const int v : t) on[v] = true;
  return on;
}

std::array<Vec3, 4> cornerGradients(const Points& vertices, const Tetrahedron& cell) {
  const Vec3& o = vertices[cell[0]];
  const Vec3 a = vertices[cell[1]] - o, b = vertices[cell[2]] - o, c = vertices[cell[3]] - o;
  const double d = dot(a, cross(b, c));
  const Vec3 ga = cross(b, c) / d, gb = cross(c, a) / d, gc = cross(a, b) / d;
  return {-(ga + gb + gc), ga, gb, gc};
}

HarmonicCells harmonicOnCells(const CellMesh& mesh, const Matrix& boundaryValues,
                              const HarmonicCellsSettings& settings) {
  if (!(settings.residual > 0 && settings.residual < 1))
    throw SettingError("residual", "must lie between 0 and 1");
  requireNumber("maxIterations", settings.maxIterations, {1});
  if (!mesh.hexahedra.empty() || mesh.tetrahedra.empty())
    throw DataError(mesh.name + ": finite elements are for tetrahedra alone");
  if (boundaryValues.rows() != mesh.vertices.size())
    throw DataError(mesh.name + ": not as many rows of values as vertices");
  return Solver(mesh, boundaryValues, settings).run();
}

std::uint64_t harmonicCellsMemory(std::size_t vertices, std::size_t tetrahedra) {
  // Triplets of 16 bytes and the matrix made of them, twice over; its factor; a few vectors.
  return 10 * 16 * tetrahedra + vertices * (8 * 16 * 3 + 30 * 8);
}

}  // namespace innermap
