#include "innermap/solve/ball_tree.h"

#include <algorithm>
#include <numeric>

namespace innermap {

BallTree::BallTree(const Points& points, const std::vector<double>& radii, std::size_t leafSize,
                   int halvings)
    : order_(points.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  if (points.empty()) return;
  nodes_.push_back(makeNode(points, radii, {0, static_cast<std::uint32_t>(points.size())}, 0));
  std::vector<Range> parts;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    if (nodes_[n].count() <= leafSize) continue;
    parts.clear();
    halve(points, {nodes_[n].begin, nodes_[n].end}, leafSize, halvings, parts);
    nodes_[n].firstChild = static_cast<std::uint32_t>(nodes_.size());
    nodes_[n].children = static_cast<std::uint32_t>(parts.size());
    const std::uint32_t depth = nodes_[n].depth + 1;
    for (const Range& part : parts) nodes_.push_back(makeNode(points, radii, part, depth));
  }
}

void BallTree::halve(const Points& points, Range range, std::size_t leafSize, int times,
                     std::vector<Range>& out) {
  const std::uint32_t count = range.second - range.first;
  if (times == 0 || count <= leafSize) {
    out.push_back(range);
    return;
  }
  const auto begin = order_.begin() + range.first, end = order_.begin() + range.second;
  Box3 box;
  for (auto i = begin; i != end; ++i) box.add(points[*i]);
  const Vec3 side = box.extent();
  const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
  std::nth_element(begin, begin + count / 2, end, [&](std::uint32_t a, std::uint32_t b) {
    const double x = points[a][axis], y = points[b][axis];
    return x < y || (x == y && a < b);
  });
  const std::uint32_t middle = range.first + count / 2;
  halve(points, {range.first, middle}, leafSize, times - 1, out);
  halve(points, {middle, range.second}, leafSize, times - 1, out);
}

BallTree::Node BallTree::makeNode(const Points& points, const std::vector<double>& radii,
                                  Range range, std::uint32_t depth) const {
  Box3 box;
  for (std::uint32_t i = range.first; i < range.second; ++i) box.add(points[order_[i]]);
  Node node;
  node.ball.center = box.center();
  for (std::uint32_t i = range.first; i < range.second; ++i) {
    const std::uint32_t p = order_[i];
    node.ball.radius = std::max(
        node.ball.radius, norm(points[p] - node.ball.center) + radii[radii.size() > 1 ? p : 0]);
  }
  node.begin = range.first;
  node.end = range.second;
  node.depth = depth;
  return node;
}

}  // namespace innermap
