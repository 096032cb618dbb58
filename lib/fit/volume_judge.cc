#include "fit/volume_judge.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "fit/detail/inside_check.h"
#include "innermap/core/error.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/mesh/mesh.h"
#include "sample/source_points.h"
#include "sample/surface_samples.h"

namespace innermap {
namespace {

constexpr std::size_t kCharges = 600, kCollocation = 1800, kJudgedPoints = 3000;
constexpr double kDepth = 0.3;            // of the charges' spacing: what is judged lies deeper
constexpr double kRegularization = 1e-5;  // Tikhonov's, of the largest singular value
constexpr double kLeastStretch = 0.02, kFolded = 20;

Mesh meshOf(const ClosedSurface& surface) {
  Mesh mesh;
  mesh.name = surface.name;
  mesh.vertices = surface.vertices;
  mesh.triangles = surface.triangles;
  return mesh;
}

Points deepOnes(const Solid& solid, double depth) {
  Points out;
  for (const Vec3& p : pointsInside(solid, 2 * kJudgedPoints))
    if (solid.distance(p) > depth) out.push_back(p);
  const std::size_t every = out.size() / kJudgedPoints + 1;
  Points some;
  for (std::size_t i = 0; i < out.size(); i += every) some.push_back(out[i]);
  return some;
}

double distortion(const FieldSamples& samples, std::size_t i, double scale) {
  Eigen::Matrix3d j;
  for (int r = 0; r < 3; ++r)
    for (int a = 0; a < 3; ++a)
      j(r, a) = scale * samples.gradients(i, static_cast<std::size_t>(3 * r + a));
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> squares;
  squares.computeDirect(j.transpose() * j, Eigen::EigenvaluesOnly);
  double sum = j.determinant() > 0 ? 0 : kFolded;
  for (int k = 0; k < 3; ++k) {
    const double stretch = std::sqrt(std::max(squares.eigenvalues()[k], 0.0));
    sum += std::pow(std::log(std::max(stretch, kLeastStretch)), 2);
  }
  return sum;
}

}  // namespace

// What the surface alone decides.
struct VolumeJudge::Placed {
  std::vector<SurfacePoint> at;
  Points collocation, sources, inside;

  explicit Placed(const ClosedSurface& surface);
};

VolumeJudge::Placed::Placed(const ClosedSurface& surface) {
  const Mesh mesh = meshOf(surface);
  const Solid solid(mesh);
  const double spacing = std::sqrt(solid.area() / static_cast<double>(kCharges));
  at = blueNoiseSamples(mesh, kCollocation);
  collocation = interpolate(mesh.vertices, mesh.triangles, at);
  SourceSettings charges;
  charges.count = kCharges;
  sources = sourceShell(solid, std::clamp(spacing / solid.diagonal(), 1e-4, 2.0), charges);
  inside = deepOnes(solid, kDepth * spacing);
  if (inside.empty()) throw DataError(surface.name + ": is too thin to judge its inside");
}

VolumeJudge::VolumeJudge(Placed placed)
    : at_(std::move(placed.at)),
      sources_(std::move(placed.sources)),
      inside_(std::move(placed.inside)),
      solver_(placed.collocation, sources_, {}) {}

VolumeJudge::VolumeJudge(const ClosedSurface& surface, double targetVolume)
    : VolumeJudge(Placed(surface)) {
  scale_ = std::cbrt(std::abs(signedVolume(meshOf(surface))) / targetVolume);
}

double VolumeJudge::score(const Points& images) const {
  Matrix values(images.size(), 3);
  for (std::size_t i = 0; i < images.size(); ++i)
    for (int k = 0; k < 3; ++k) values(i, static_cast<std::size_t>(k)) = images[i][k];
  DenseSolution solved = solver_.solve(values, Regularization::tikhonov, {}, kRegularization);
  EvaluateFieldSettings settings;
  settings.gradients = true;
  const FieldSamples samples =
      HarmonicField(sources_, std::move(solved.weights), std::move(solved.affine))
          .evaluate(inside_, settings);
  double sum = 0;
  for (std::size_t i = 0; i < inside_.size(); ++i) sum += distortion(samples, i, scale_);
  return sum / static_cast<double>(inside_.size());
}

}  // namespace innermap
