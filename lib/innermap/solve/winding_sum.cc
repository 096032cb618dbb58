#include "innermap/solve/winding_sum.h"

#include <algorithm>
#include <cmath>

#include "innermap/core/error.h"
#include "innermap/core/parallel.h"
#include "innermap/solve/detail/descent.h"
#include "innermap/solve/detail/dipole_moments.h"
#include "innermap/solve/detail/sum_plan.h"

namespace innermap {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::size_t kTrianglesPerLeaf = 24, kPointsPerLeaf = 200, kSampled = 24;
constexpr double kLeastRadius = 1e-9;

// Van Oosterom and Strackee, "The Solid Angle of a Plane Triangle" (IEEE Trans. Biomed. Eng. 1983).
double solidAngle(const Corners& t, const Vec3& p) {
  const Vec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
  const double la = norm(a), lb = norm(b), lc = norm(c);
  const double re = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return 2 * std::atan2(dot(a, cross(b - a, c - a)), re);
}

std::vector<Corners> localTriangles(const Points& vertices,
                                    const std::vector<std::array<int, 3>>& triangles,
                                    const Vec3& center, double inverseScale) {
  std::vector<Corners> out(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c) {
      const int v = triangles[t][c];
      if (v < 0 || static_cast<std::size_t>(v) >= vertices.size())
        throw DataError("winding number: triangle " + std::to_string(t) + " has vertex " +
                        std::to_string(v) + " of " + std::to_string(vertices.size()));
      out[t][c] = inverseScale * (vertices[static_cast<std::size_t>(v)] - center);
      if (!isFinite(out[t][c]))
        throw DataError("winding number: vertex " + std::to_string(v) + " is not finite");
    }
  return out;
}

Points centroids(const std::vector<Corners>& triangles) {
  Points out(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    out[t] = (triangles[t][0] + triangles[t][1] + triangles[t][2]) / 3;
  return out;
}

std::vector<double> radii(const std::vector<Corners>& triangles) {
  // Never one entry alone, which would count for all.
  std::vector<double> out(std::max<std::size_t>(2, triangles.size()), kLeastRadius);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Vec3 center = (triangles[t][0] + triangles[t][1] + triangles[t][2]) / 3;
    for (const Vec3& v : triangles[t]) out[t] = std::max(out[t], norm(v - center));
  }
  return out;
}

std::vector<Corners> inOrder(const std::vector<Corners>& triangles, const BallTree& balls) {
  std::vector<Corners> out;
  out.reserve(triangles.size());
  for (const std::uint32_t t : balls.order()) out.push_back(triangles[t]);
  return out;
}

}  // namespace

struct WindingSum::Data {
  Vec3 center;
  double inverseScale;
  BallTree balls;
  std::vector<Corners> triangles;  // in the order of the tree

  double exactAt(const Vec3& local) const {
    double sum = 0;
    for (const Corners& t : triangles) sum += solidAngle(t, local);
    return sum / (4 * kPi);
  }

  void hierarchicalAt(const Points& local, const FarFieldSettings& plan, Progress* progress,
                      std::vector<double>& out) const;
};

WindingSum::WindingSum(const Points& vertices, const std::vector<std::array<int, 3>>& triangles) {
  const Box3 box = boundingBox(vertices);
  const Vec3 center = box.empty() ? Vec3{} : box.center();
  const double inverse = box.diagonal() > 0 ? 1 / box.diagonal() : 1;
  const std::vector<Corners> local = localTriangles(vertices, triangles, center, inverse);
  BallTree balls(centroids(local), radii(local), kTrianglesPerLeaf, 1);
  std::vector<Corners> sorted = inOrder(local, balls);
  data_ = std::make_shared<const Data>(Data{center, inverse, std::move(balls), std::move(sorted)});
}

double WindingSum::exactAt(const Vec3& point) const {
  return data_->exactAt(data_->inverseScale * (point - data_->center));
}

void WindingSum::Data::hierarchicalAt(const Points& local, const FarFieldSettings& plan,
                                      Progress* progress, std::vector<double>& out) const {
  const auto basis = ExpansionBasis::get(plan.order);
  const DipoleMoments moments(basis->harmonics());
  const Proxies proxies(
      balls, basis,
      [&](const BallTree::Node& leaf, double* to) {
        moments.add(triangles.data() + leaf.begin, leaf.count(), leaf.ball, to);
      },
      progress);
  const FarField field(proxies, plan);
  const BallTree targets(local, {kLeastRadius}, kPointsPerLeaf, 3);
  descendToNodes(
      field, targets,
      [&](const BallTree::Node& leaf, const Expansion& expansion,
          const std::vector<std::uint32_t>& near, LeafSums& sums) {
        const std::uint32_t* order = targets.order().data() + leaf.begin;
        sums.polynomialAt(field, local, order, leaf.count(), expansion);
        for (std::size_t i = 0; i < leaf.count(); ++i) {
          double sum = sums.values()[i];
          for (const std::uint32_t n : near)
            for (std::uint32_t t = balls.nodes()[n].begin; t < balls.nodes()[n].end; ++t)
              sum += solidAngle(triangles[t], local[order[i]]);
          out[order[i]] = sum / (4 * kPi);
        }
      },
      progress);
}

std::vector<double> WindingSum::at(const Points& points, double accuracy, Progress* progress,
                                   SumMethod method) const {
  if (!(accuracy >= 1e-12 && accuracy <= 0.1))
    throw SettingError("accuracy", "of winding numbers must lie in 1e-12 to 0.1");
  Points local(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    local[i] = data_->inverseScale * (points[i] - data_->center);
    if (!isFinite(local[i]))
      throw DataError("winding number: point " + std::to_string(i) + " is not finite");
  }
  std::vector<double> out(points.size(), 0.0);
  FarFieldSettings plan = planFor(accuracy);
  const SumSize size{data_->triangles.size(), points.size(), kPointsPerLeaf, plan.order, true};
  if (points.empty() || data_->triangles.empty()) return out;
  while (useHierarchy(size, method) && plan.order <= ExpansionBasis::kMostOrder) {
    data_->hierarchicalAt(local, plan, progress, out);
    double squared = 0;
    for (std::size_t i = 0; i < kSampled; ++i) {
      const std::size_t p = i * local.size() / kSampled;
      const double error = out[p] - data_->exactAt(local[p]);
      squared += error * error;
    }
    const double excess = std::sqrt(squared / kSampled) / accuracy;
    if (excess <= 1) return out;
    plan = raised(plan, excess);
  }
  parallelBlocks(
      points.size(), 64,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) out[i] = data_->exactAt(local[i]);
      },
      progress, "winding numbers");
  return out;
}

}  // namespace innermap
