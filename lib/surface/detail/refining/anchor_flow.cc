#include "surface/detail/refining/anchor_flow.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "innermap/core/run.h"
#include "surface/detail/sphere/star_kernel.h"

namespace innermap {
namespace {

constexpr double kReach = 0.6;     // of a velocity around an anchor, radians
constexpr double kLongest = 0.15;  // step of an anchor
constexpr int kSteps = 300;
constexpr int kRelaxed = 3;        // steps from one relaxation to the next
constexpr double kArrived = 1e-7;  // then anchors are set to their targets

// Matern kernel of smoothness 3/2: its fields are differentiable, its matrix well conditioned.
double kernel(double distance) {
  const double r = distance / kReach;
  return (1 + r) * std::exp(-r);
}

// Takes vertices one by one as far along their ways as the triangles around them stay positive.
void advance(const ProgressiveMesh& mesh, Layout& layout, const Points& place) {
  Ring ring;
  RingPlaces around;
  for (int v = 0; v < static_cast<int>(mesh.capacity()); ++v) {
    if (!mesh.present(v)) continue;
    mesh.ring(v, ring);
    ringPlaces(layout, ring, around);
    const Vec3 from = layout.place[v], way = place[v] - from;
    for (double share = 1; share > 0.05; share *= 0.6) {
      const Vec3 to = moveAlong(layout.space, from, share * way);
      if (!starIsValid(to, around)) continue;
      layout.place[v] = to;
      break;
    }
  }
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

// Sets the first anchors, which are next to their targets, to them.
bool arrive(const ProgressiveMesh& mesh, Layout& layout, const std::vector<Anchor>& anchors,
            std::size_t count) {
  Ring ring;
  RingPlaces around;
  for (std::size_t i = 0; i < count; ++i) {
    const Anchor& a = anchors[i];
    mesh.ring(a.vertex, ring);
    ringPlaces(layout, ring, around);
    const Vec3 to = nearestCopy(layout, layout.place[a.vertex], a.target);
    if (!starIsValid(to, around)) return false;
    layout.place[a.vertex] = to;
  }
  return true;
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
                CoarseToFine& relaxer, const FlowSettings& settings) {
  if (anchors.empty()) return -1;
  Points way(anchors.size()), place = layout.place;
  double nearest = 1e300;
  int farthest = 0, stuck = 0;
  for (int i = 0; i < kSteps && stuck < settings.patience; ++i) {
    throwIfCancelled();
    double longest = 0, sum = 0;
    bool arrived = true;
    for (std::size_t k = 0; k < anchors.size(); ++k) {
      way[k] = wayTo(layout, layout.place[anchors[k].vertex], anchors[k].target);
      const double length = norm(way[k]);
      arrived = arrived && length < (k < settings.exact ? kArrived : settings.near);
      sum += length;
      if (length <= longest) continue;
      longest = length;
      farthest = static_cast<int>(k);
    }
    if (arrived && arrive(mesh, layout, anchors, settings.exact)) return -1;
    stuck = sum < 0.98 * nearest ? 0 : stuck + 1;
    nearest = std::min(nearest, sum);
    flowStep(layout, anchors, way, std::min(1.0, kLongest / longest), mesh, place);
    advance(mesh, layout, place);
    if (stuck > 0 || i % kRelaxed == 0) relaxer.relaxAll(1);
  }
  return farthest;
}

}  // namespace innermap
