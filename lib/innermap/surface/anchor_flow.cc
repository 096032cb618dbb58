#include "innermap/surface/anchor_flow.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "innermap/surface/star_kernel.h"

namespace innermap {
namespace {

constexpr double kReach = 0.6;    // of a velocity around an anchor, radians
constexpr double kLongest = 0.1;  // step of an anchor
constexpr int kSteps = 400;
constexpr double kArrived = 1e-7;  // then anchors are set to their targets

// Matern kernel of smoothness 3/2: its fields are differentiable, its matrix well conditioned.
double kernel(double distance) {
  const double r = distance / kReach;
  return (1 + r) * std::exp(-r);
}

bool isValid(const ProgressiveMesh& mesh, const Layout& layout, const Points& place) {
  for (int t = 0; t < static_cast<int>(mesh.triangleCount()); ++t) {
    if (!mesh.alive(t)) continue;
    Vec3 p[3];
    for (int k = 0; k < 3; ++k) {
      p[k] = place[mesh.triangle(t)[k]];
      if (!layout.shift.empty()) p[k] = layout.moved(p[k], mesh.shift(t, k));
    }
    if (!(tripleProduct(p[0], p[1], p[2]) > 0)) return false;
  }
  return true;
}

// Velocities of all points that interpolate `way` at the anchors.
void flowStep(const Layout& layout, const std::vector<Anchor>& anchors, const Points& way,
              double share, const ProgressiveMesh& mesh, Points& place) {
  const auto n = static_cast<Eigen::Index>(anchors.size());
  Eigen::MatrixXd matrix(n, n), right(n, 3);
  const auto distance = [&](const Vec3& p, const Vec3& q) { return norm(wayTo(layout, p, q)); };
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3& p = layout.place[anchors[static_cast<std::size_t>(i)].vertex];
    for (Eigen::Index j = 0; j < n; ++j)
      matrix(i, j) = kernel(distance(p, layout.place[anchors[static_cast<std::size_t>(j)].vertex]));
    matrix(i, i) += 1e-9;
    for (int a = 0; a < 3; ++a) right(i, a) = way[static_cast<std::size_t>(i)][a];
  }
  const Eigen::MatrixXd weights = matrix.ldlt().solve(right);
  for (int v = 0; v < static_cast<int>(mesh.capacity()); ++v) {
    if (!mesh.present(v)) continue;
    const Vec3& p = layout.place[v];
    Vec3 velocity;
    for (Eigen::Index j = 0; j < n; ++j) {
      const double k =
          kernel(distance(p, layout.place[anchors[static_cast<std::size_t>(j)].vertex]));
      velocity += k * Vec3{weights(j, 0), weights(j, 1), weights(j, 2)};
    }
    if (layout.space == ModelSpace::sphere) velocity = velocity - dot(velocity, p) * p;
    place[v] = moveAlong(layout.space, p, share * velocity);
  }
}

Vec3 nearestCopy(const Layout& layout, const Vec3& from, const Vec3& to) {
  return layout.space == ModelSpace::sphere ? to : from + wayTo(layout, from, to);
}

}  // namespace

Vec3 wayTo(const Layout& layout, const Vec3& from, const Vec3& to) {
  if (layout.space == ModelSpace::torus) {
    const Vec3 d = to - from;
    const Vec3 &p = layout.period[0], &q = layout.period[1];
    const double det = p.x * q.y - p.y * q.x;
    const double a = std::round((d.x * q.y - d.y * q.x) / det),
                 b = std::round((p.x * d.y - p.y * d.x) / det);
    Vec3 best = d - (a * p + b * q);
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j) {
        const Vec3 other = d - ((a + i) * p + (b + j) * q);
        if (squaredNorm(other) < squaredNorm(best) * (1 - 1e-12)) best = other;
      }
    return best;
  }
  const Vec3 tangent = to - dot(from, to) * from;
  const double sine = norm(tangent), angle = std::atan2(sine, dot(from, to));
  if (sine > 1e-12) return (angle / sine) * tangent;
  // The same point, or the opposite one, to which all ways are as long.
  return dot(from, to) > 0 ? tangent : angle * tangentAt(layout.space, from).u;
}

int pullAnchors(const ProgressiveMesh& mesh, Layout& layout, const std::vector<Anchor>& anchors,
                CoarseToFine& relaxer, Progress* progress) {
  if (anchors.empty()) return -1;
  Points way(anchors.size()), place = layout.place;
  double stuck = 0;
  int farthest = 0;
  for (int i = 0; i < kSteps; ++i) {
    throwIfCancelled(progress);
    double longest = 0;
    for (std::size_t k = 0; k < anchors.size(); ++k) {
      way[k] = wayTo(layout, layout.place[anchors[k].vertex], anchors[k].target);
      if (norm(way[k]) > longest) {
        longest = norm(way[k]);
        farthest = static_cast<int>(k);
      }
    }
    if (longest < kArrived) {
      place = layout.place;
      for (const Anchor& a : anchors)
        place[a.vertex] = nearestCopy(layout, place[a.vertex], a.target);
      if (!isValid(mesh, layout, place)) return farthest;
      layout.place = place;
      return -1;
    }
    bool moved = false;
    double share = std::min(1.0, kLongest / longest);
    for (int halving = 0; halving < 8 && !moved; ++halving, share *= 0.5) {
      flowStep(layout, anchors, way, share, mesh, place);
      moved = isValid(mesh, layout, place);
    }
    if (moved) layout.place = place;
    stuck = moved ? 0 : stuck + 1;
    if (stuck > 4) return farthest;
    relaxer.relaxAll(moved ? 1 : 3);
  }
  return farthest;
}

}  // namespace innermap
