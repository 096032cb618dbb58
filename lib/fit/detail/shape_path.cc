#include "fit/detail/shape_path.h"

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <optional>

#include "fit/detail/shape_smoother.h"
#include "fit/detail/triangle_turns.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Weight of the straight way of each vertex beside that of its edges: keeps parts that nothing
// connects where they belong, and is too small to bend anything.
constexpr double kStraight = 1e-6;
constexpr double kLeastCotangent = 0.02, kMostCotangent = 50;

// The cotangent of the angle at `c` in the triangle a, b, c; of slivers what is nearest to it among
// the weights that keep a sum over edges well posed.
double edgeWeight(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double area = norm(cross(a - c, b - c));
  return area > 0 ? std::clamp(dot(a - c, b - c) / area, kLeastCotangent, kMostCotangent)
                  : kLeastCotangent;
}

// Columns: two edges and the normal, as long as the root of the area.
Matrix3d frameOf(const Points& at, const Triangle& t) {
  const Vec3 a = at[t[1]] - at[t[0]], b = at[t[2]] - at[t[0]], n = cross(a, b);
  const double length = norm(n);
  Matrix3d out;
  out.col(0) = vector(a);
  out.col(1) = vector(b);
  out.col(2) = length > 0 ? vector(n / std::sqrt(length)) : Vector3d::Zero();
  return out;
}

Matrix3d turnedBy(const Vector3d& turn) {
  const double angle = turn.norm();
  if (angle == 0) return Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
}

// A triangle's deformation: exp(turn) stretch, and the weights of its edges.
struct Deformation {
  Vector3d turn = Vector3d::Zero();  // axis times angle
  Matrix3d stretch = Matrix3d::Identity();
  double weight[3] = {};  // of the edge after corner k

  Matrix3d at(double t) const {
    return turnedBy(t * turn) * ((1 - t) * Matrix3d::Identity() + t * stretch);
  }
};

// Empty where the triangle has no area.
std::optional<Matrix3d> gradientOf(const Points& from, const Points& to, const Triangle& t) {
  const Matrix3d before = frameOf(from, t), after = frameOf(to, t);
  const double size = before.col(0).norm() * before.col(1).norm() * before.col(2).norm();
  if (!(std::abs(before.determinant()) > 1e-12 * size)) return {};
  return after * before.inverse();
}

// Any positive weights give both ends exactly.
void weigh(const Points& from, const Triangle& t, Deformation& out) {
  for (int k = 0; k < 3; ++k)
    out.weight[k] = edgeWeight(from[t[k]], from[t[(k + 1) % 3]], from[t[(k + 2) % 3]]);
}

std::vector<Deformation> deformationsOf(const Points& from, const Points& to,
                                        const std::vector<Triangle>& triangles) {
  std::vector<Matrix3d> gradients(triangles.size(), Matrix3d::Identity()), rotations = gradients;
  std::vector<bool> known(triangles.size(), false);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (const auto gradient = gradientOf(from, to, triangles[t])) {
      gradients[t] = *gradient;
      rotations[t] = rotationOf(*gradient);
      known[t] = true;
    }
  const std::vector<Vector3d> turns = turnsOf(triangles, rotations, known);
  std::vector<Deformation> out(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    weigh(from, triangles[t], out[t]);
    out[t].turn = turns[t];
    out[t].stretch = turnedBy(turns[t]).transpose() * gradients[t];
  }
  return out;
}

}  // namespace

struct ShapePath::Implementation {
  ScaledMotion rest;
  Points from, to;  // `to` as at(1)
  std::vector<Triangle> triangles;
  std::vector<Deformation> deformations;
  double straight = 0;  // the weight of a vertex's straight way
  std::optional<ShapeSmoother> smoother;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;

  void factor() {
    std::vector<Eigen::Triplet<double>> entries;
    double sum = 0;
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const int i = triangles[t][k], j = triangles[t][(k + 1) % 3];
        const double w = deformations[t].weight[k];
        sum += w;
        entries.insert(entries.end(), {{i, i, w}, {j, j, w}, {i, j, -w}, {j, i, -w}});
      }
    const auto count = static_cast<int>(from.size());
    straight = kStraight * std::max(sum / count, 1e-12);
    for (int v = 0; v < count; ++v) entries.push_back({v, v, straight});
    Eigen::SparseMatrix<double> matrix(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    solver.compute(matrix);
    if (solver.info() != Eigen::Success) throw DataError("the surface is too thin to interpolate");
  }
};

ShapePath::ShapePath(const Points& from, const Points& to, const std::vector<Triangle>& triangles,
                     double growth, Between between) {
  auto out = std::make_unique<Implementation>();
  out->rest = alignment(from, to, triangles, growth);
  out->from = from;
  out->to = movedBack(out->rest, to);
  out->triangles = triangles;
  out->deformations = deformationsOf(from, out->to, triangles);
  out->factor();
  if (between == Between::smoothed) out->smoother.emplace(from, out->to, triangles);
  implementation_ = std::move(out);
}

ShapePath::~ShapePath() = default;
ShapePath::ShapePath(ShapePath&&) noexcept = default;

const ScaledMotion& ShapePath::rest() const { return implementation_->rest; }

Points ShapePath::at(double t) const {
  const Implementation& d = *implementation_;
  if (t <= 0) return d.from;
  if (t >= 1) return d.to;
  Eigen::MatrixX3d right(static_cast<Eigen::Index>(d.from.size()), 3);
  for (std::size_t v = 0; v < d.from.size(); ++v)
    right.row(static_cast<Eigen::Index>(v)) =
        d.straight * vector((1 - t) * d.from[v] + t * d.to[v]).transpose();
  for (std::size_t i = 0; i < d.triangles.size(); ++i) {
    const Triangle& corners = d.triangles[i];
    const Matrix3d m = d.deformations[i].at(t);
    for (int k = 0; k < 3; ++k) {
      const int a = corners[k], b = corners[(k + 1) % 3];
      const Vector3d edge = d.deformations[i].weight[k] * (m * vector(d.from[a] - d.from[b]));
      right.row(a) += edge.transpose();
      right.row(b) -= edge.transpose();
    }
  }
  const Eigen::MatrixX3d solved = d.solver.solve(right);
  Points out(d.from.size());
  for (std::size_t v = 0; v < out.size(); ++v)
    out[v] = point(solved.row(static_cast<Eigen::Index>(v)).transpose());
  return d.smoother ? d.smoother->smoothed(out, t) : out;
}

}  // namespace innermap
