#include "fit/detail/shape_smoother.h"

#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <optional>

#include "fit/detail/scaled_motion.h"
#include "innermap/core/error.h"
#include "innermap/surface/correspond.h"

namespace innermap {
namespace {

// tau half way, of surfaces of area 1: on the sphere degree 1 keeps 0.78, degree 4 0.14. In the
// mean of two metrics seven times as much made stubs of limbs, which took three times as long to
// grow again.
constexpr double kSphereTime = 0.01, kMeanTime = 0.003;
constexpr int kFlowSteps = 4;  // implicit ones
// Of the square of a triangle's longest edge, its area: slivers count as no thinner. All three
// weights of one shrink alike, so that the matrix stays positive.
constexpr double kThinnest = 1e-6;
// Beyond this the volume is no measure of a shape's size: it runs through itself.
constexpr double kMostGrowth = 2;

using Sparse = Eigen::SparseMatrix<double>;

Eigen::MatrixX3d matrixOf(const Points& points) {
  Eigen::MatrixX3d out(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t v = 0; v < points.size(); ++v)
    out.row(static_cast<Eigen::Index>(v)) = vector(points[v]).transpose();
  return out;
}

// The vertices laid out on a sphere by area. Empty where the surface is not one closed one without
// handles. Vertices that it has no use for are amid their neighbours.
std::optional<Points> onSphere(const Points& from, const std::vector<Triangle>& triangles) try {
  Mesh mesh;
  mesh.vertices = from;
  mesh.triangles = triangles;
  const EmbeddedSurface laidOut(mesh);
  const SurfaceShells& surfaces = laidOut.surfaces();
  if (surfaces.shells.size() != 1 || surfaces.shells.front().genus != 0) return {};
  Points out(from.size());
  std::vector<bool> placed(from.size(), false);
  for (std::size_t v = 0; v < from.size(); ++v)
    if (const int i = surfaces.shellVertex[v].vertex; i >= 0) {
      out[v] = laidOut.layout(0).place[static_cast<std::size_t>(i)];
      placed[v] = true;
    }
  std::vector<int> neighbours(from.size(), 0);
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k)
      for (const int n : {t[(k + 1) % 3], t[(k + 2) % 3]})
        if (!placed[t[k]] && placed[n])
          out[t[k]] = out[t[k]] + (out[n] - out[t[k]]) / ++neighbours[t[k]];
  return out;
} catch (const DataError&) {
  return {};
}

}  // namespace

struct ShapeSmoother::Implementation {
  std::vector<Triangle> triangles;
  double volume = 0;
  double time = 0;
  Eigen::VectorXd masses;
  Sparse stiffness;
  Eigen::SimplicialLDLT<Sparse> solver;

  // The mean of the metrics of these positions.
  void measure(const std::vector<Points>& metrics) {
    const auto count = static_cast<int>(metrics.front().size());
    const double share = 1 / static_cast<double>(metrics.size());
    masses = Eigen::VectorXd::Zero(count);
    std::vector<Eigen::Triplet<double>> entries;
    for (int v = 0; v < count; ++v) entries.emplace_back(v, v, 0);
    for (const Points& at : metrics) add(at, share, entries);
    // Vertices of no area go with their neighbours, those in no triangle stay where they are.
    masses = masses.cwiseMax(1e-9 / count);
    stiffness.resize(count, count);
    stiffness.setFromTriplets(entries.begin(), entries.end());
    solver.analyzePattern(stiffness);
  }

  void add(const Points& at, double share, std::vector<Eigen::Triplet<double>>& entries) {
    double total = 0;
    const auto areaOf = [&](const Triangle& t) {
      return norm(cross(at[t[1]] - at[t[0]], at[t[2]] - at[t[0]])) / 2;
    };
    for (const Triangle& t : triangles) total += areaOf(t);
    if (!(total > 0)) throw DataError("the surface has no area");
    for (const Triangle& t : triangles) {
      const double area = areaOf(t);
      double longest = 0;
      for (int k = 0; k < 3; ++k) longest = std::max(longest, norm(at[t[(k + 1) % 3]] - at[t[k]]));
      const double twice = 2 * std::max(area, kThinnest * longest * longest);
      for (int k = 0; k < 3 && twice > 0; ++k) {
        const int i = t[k], j = t[(k + 1) % 3], c = t[(k + 2) % 3];
        masses[i] += share * area / 3 / total;
        const double w = share * dot(at[i] - at[c], at[j] - at[c]) / twice / 2;
        entries.insert(entries.end(), {{i, i, w}, {j, j, w}, {i, j, -w}, {j, i, -w}});
      }
    }
  }

  Eigen::RowVector3d middle(const Eigen::MatrixX3d& at) const {
    return masses.transpose() * at / masses.sum();
  }

  double spread(const Eigen::MatrixX3d& at) const {
    return std::sqrt(masses.dot((at.rowwise() - middle(at)).rowwise().squaredNorm()));
  }

  Eigen::MatrixX3d flow(Eigen::MatrixX3d at, double tau) {
    Sparse matrix = tau / kFlowSteps * stiffness;
    matrix.diagonal() += masses;
    solver.factorize(matrix);
    if (solver.info() != Eigen::Success) throw DataError("the surface is too thin to smooth");
    for (int k = 0; k < kFlowSteps; ++k)
      at = solver.solve(Eigen::MatrixX3d(masses.asDiagonal() * at));
    return at;
  }
};

ShapeSmoother::ShapeSmoother(const Points& from, const Points& to,
                             const std::vector<Triangle>& triangles) {
  auto out = std::make_unique<Implementation>();
  out->triangles = triangles;
  out->volume = signedVolume(from, triangles);
  const std::optional<Points> sphere = onSphere(from, triangles);
  out->time = sphere ? kSphereTime : kMeanTime;
  out->measure(sphere ? std::vector<Points>{*sphere} : std::vector<Points>{from, to});
  implementation_ = std::move(out);
}

ShapeSmoother::~ShapeSmoother() = default;
ShapeSmoother::ShapeSmoother(ShapeSmoother&&) noexcept = default;

Points ShapeSmoother::smoothed(const Points& shape, double t) const {
  Implementation& d = *implementation_;
  const double way = 2 * std::clamp(std::min(t, 1 - t), 0.0, 0.5);  // from the nearer end
  if (!(way > 0)) return shape;
  const Eigen::MatrixX3d before = matrixOf(shape), at = d.flow(before, d.time * way * way);
  const Eigen::RowVector3d middle = d.middle(at);
  const auto grown = [&](double growth) {
    Points out(shape.size());
    for (std::size_t v = 0; v < out.size(); ++v) {
      const Eigen::RowVector3d p =
          middle + growth * (at.row(static_cast<Eigen::Index>(v)) - middle);
      out[v] = {p[0], p[1], p[2]};
    }
    return out;
  };
  const double bySpread = d.spread(before) / d.spread(at);
  Points out = grown(bySpread);
  const double more = std::cbrt(d.volume / signedVolume(out, d.triangles));
  return more > 0 && more <= kMostGrowth ? grown(more * bySpread) : out;
}

}  // namespace innermap
