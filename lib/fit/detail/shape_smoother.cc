#include "fit/detail/shape_smoother.h"

#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/pi.h"
#include "fit/detail/scaled_motion.h"
#include "innermap/core/error.h"
#include "innermap/surface/correspond.h"

namespace innermap {
namespace {

constexpr double kLeastCotangent = 0.02, kMostCotangent = 50;
// Of the area, and the part of the way at each end on which s goes from 0 to 1. Without the ball a
// tenth of this lambda left crossings between solids with limbs and pits; seven times as much made
// stubs of limbs, and growing them again took three times as long.
constexpr double kLambda = 0.003, kRamp = 0.25;
// Beyond this the volume is no measure of a shape's size: it runs through itself.
constexpr double kMostGrowth = 2;

using Sparse = Eigen::SparseMatrix<double>;

Eigen::MatrixX3d matrixOf(const Points& points) {
  Eigen::MatrixX3d out(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t v = 0; v < points.size(); ++v)
    out.row(static_cast<Eigen::Index>(v)) = vector(points[v]).transpose();
  return out;
}

// The surface as a ball that lies as the two do on average, as large as `from`. Empty where it is
// not one closed surface without handles. Vertices in no triangle stay half way.
std::optional<Eigen::MatrixX3d> ballOf(const Points& from, const Points& to,
                                       const std::vector<Triangle>& triangles) try {
  Mesh mesh;
  mesh.vertices = from;
  mesh.triangles = triangles;
  const EmbeddedSurface laidOut(mesh);
  const SurfaceShells& surfaces = laidOut.surfaces();
  if (surfaces.shells.size() != 1 || surfaces.shells.front().genus != 0) return {};
  Points middle(from.size()), sphere(from.size());
  for (std::size_t v = 0; v < from.size(); ++v) {
    middle[v] = 0.5 * (from[v] + to[v]);
    if (const int i = surfaces.shellVertex[v].vertex; i >= 0)
      sphere[v] = laidOut.layout(0).place[static_cast<std::size_t>(i)];
  }
  const double radius = std::cbrt(std::abs(signedVolume(from, triangles)) / (4 * kPi / 3));
  if (!(radius > 0)) return {};
  Points ball = movedBack(alignment(middle, sphere, triangles, 1 / radius), sphere);
  for (std::size_t v = 0; v < ball.size(); ++v)
    if (surfaces.shellVertex[v].vertex < 0) ball[v] = middle[v];
  return matrixOf(ball);
} catch (const DataError&) {
  return {};
}

}  // namespace

double edgeWeight(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double area = norm(cross(a - c, b - c));
  return area > 0 ? std::clamp(dot(a - c, b - c) / area, kLeastCotangent, kMostCotangent)
                  : kLeastCotangent;
}

struct ShapeSmoother::Implementation {
  std::vector<Triangle> triangles;
  double volume = 0;
  Eigen::VectorXd masses;
  std::optional<Eigen::MatrixX3d> ball;
  Eigen::SimplicialLDLT<Sparse> solver;

  void add(const Points& at, std::vector<Eigen::Triplet<double>>& entries) {
    double total = 0;
    const auto areaOf = [&](const Triangle& t) {
      return norm(cross(at[t[1]] - at[t[0]], at[t[2]] - at[t[0]])) / 2;
    };
    for (const Triangle& t : triangles) total += areaOf(t);
    if (!(total > 0)) throw DataError("the surface has no area");
    for (const Triangle& t : triangles)
      for (int k = 0; k < 3; ++k) {
        const int i = t[k], j = t[(k + 1) % 3];
        masses[i] += areaOf(t) / 3 / total / 2;
        const double w = kLambda * edgeWeight(at[i], at[j], at[t[(k + 2) % 3]]) / 2 / 2;
        entries.insert(entries.end(), {{i, i, w}, {j, j, w}, {i, j, -w}, {j, i, -w}});
      }
  }
};

ShapeSmoother::ShapeSmoother(const Points& from, const Points& to,
                             const std::vector<Triangle>& triangles) {
  auto out = std::make_unique<Implementation>();
  out->triangles = triangles;
  out->volume = signedVolume(from, triangles);
  out->ball = ballOf(from, to, triangles);
  const auto count = static_cast<int>(from.size());
  out->masses = Eigen::VectorXd::Zero(count);
  std::vector<Eigen::Triplet<double>> entries;
  out->add(from, entries);
  out->add(to, entries);
  // Vertices of no area go with their neighbours, those in no triangle stay where they are.
  out->masses = out->masses.cwiseMax(1e-9 / count);
  for (int v = 0; v < count; ++v) entries.emplace_back(v, v, out->masses[v]);
  Sparse matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  out->solver.compute(matrix);
  if (out->solver.info() != Eigen::Success) throw DataError("the surface is too thin to smooth");
  implementation_ = std::move(out);
}

ShapeSmoother::~ShapeSmoother() = default;
ShapeSmoother::ShapeSmoother(ShapeSmoother&&) noexcept = default;

Points ShapeSmoother::smoothed(const Points& shape, double t) const {
  const Implementation& d = *implementation_;
  const double way = std::clamp(std::min(t, 1 - t), 0.0, 0.5);  // from the nearer end
  Eigen::MatrixX3d at = matrixOf(shape);
  const Eigen::MatrixX3d smooth = d.solver.solve(Eigen::MatrixX3d(d.masses.asDiagonal() * at));
  at += std::min(way / kRamp, 1.0) * (smooth - at);
  if (d.ball) at += 2 * way * (*d.ball - at);
  const Eigen::RowVector3d middle = d.masses.transpose() * at / d.masses.sum();
  const auto points = [&](double growth) {
    Points out(shape.size());
    for (std::size_t v = 0; v < out.size(); ++v) {
      const Eigen::RowVector3d p =
          middle + growth * (at.row(static_cast<Eigen::Index>(v)) - middle);
      out[v] = {p[0], p[1], p[2]};
    }
    return out;
  };
  Points out = points(1);
  const double growth = std::cbrt(d.volume / signedVolume(out, d.triangles));
  return growth > 0 && growth <= kMostGrowth ? points(growth) : out;
}

}  // namespace innermap
