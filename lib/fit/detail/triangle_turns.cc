#include "fit/detail/triangle_turns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <queue>
#include <tuple>

#include "core/pi.h"

namespace innermap {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Turns smaller than it have no axis.
constexpr double kNoAxis = 1e-9;

// Triangles that share an edge, each pair both ways, in order.
std::vector<std::array<int, 2>> neighbourPairs(const std::vector<Triangle>& triangles,
                                               const std::vector<bool>& known) {
  std::vector<std::array<int, 3>> edges;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3 && known[t]; ++k) {
      const auto [low, high] = std::minmax({triangles[t][k], triangles[t][(k + 1) % 3]});
      edges.push_back({low, high, static_cast<int>(t)});
    }
  std::sort(edges.begin(), edges.end());
  std::vector<std::array<int, 2>> pairs;
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (std::size_t j = i + 1;
         j < edges.size() && edges[j][0] == edges[i][0] && edges[j][1] == edges[i][1]; ++j) {
      pairs.push_back({edges[i][2], edges[j][2]});
      pairs.push_back({edges[j][2], edges[i][2]});
    }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

// The logarithm nearest to `beside`.
Vector3d turnBeside(const Matrix3d& rotation, const Vector3d& beside) {
  const Eigen::AngleAxisd own(rotation);
  Vector3d axis = own.axis();
  double angle = own.angle();
  if (angle < kNoAxis) {  // any axis will do
    if (!(beside.norm() > kNoAxis)) return angle * axis;
    axis = beside.normalized();
    angle = 0;
  }
  return (angle + 2 * kPi * std::round((beside.dot(axis) - angle) / (2 * kPi))) * axis;
}

}  // namespace

std::vector<Vector3d> turnsOf(const std::vector<Triangle>& triangles,
                              const std::vector<Matrix3d>& rotations,
                              const std::vector<bool>& known) {
  const auto pairs = neighbourPairs(triangles, known);
  std::vector<int> order(triangles.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return rotations[a].trace() > rotations[b].trace(); });
  std::vector<Vector3d> turns(triangles.size(), Vector3d::Zero());
  std::vector<bool> done(triangles.size(), false);
  using Step = std::tuple<double, int, int>;  // difference, triangle, where from
  for (const int root : order) {
    if (!known[root] || done[root]) continue;
    std::priority_queue<Step, std::vector<Step>, std::greater<>> queue;
    queue.push({0, root, root});
    while (!queue.empty()) {
      const auto [difference, t, from] = queue.top();
      queue.pop();
      if (done[t]) continue;
      done[t] = true;
      turns[t] = turnBeside(rotations[t], turns[from]);
      for (auto at = std::lower_bound(pairs.begin(), pairs.end(), std::array<int, 2>{t, -1});
           at != pairs.end() && (*at)[0] == t; ++at)
        if (const int next = (*at)[1]; !done[next])
          queue.push({3 - (rotations[t].transpose() * rotations[next]).trace(), next, t});
    }
  }
  return turns;
}

}  // namespace innermap
