#include "solve/detail/ball_tree.h"

#include <algorithm>

#include "innermap/core/run.h"

namespace innermap {

// Positions move with their indices: halving reads memory in order.
struct BallTree::Item {
  Vec3 position;
  std::uint32_t index = 0;
};

namespace {

using Range = std::pair<std::uint32_t, std::uint32_t>;

constexpr std::uint32_t kManyPoints = 8192;  // whose parts are worth a thread each

template <typename Body>
void forParts(std::size_t parts, std::uint32_t points, const Body& body) {
  if (points >= kManyPoints)
    return parallelBlocks(parts, 1, [&](std::size_t part, std::size_t) { body(part); });
  for (std::size_t part = 0; part < parts; ++part) body(part);
}

const Vec3& positionOf(const Vec3& p) { return p; }
template <typename Item>
const Vec3& positionOf(const Item& item) {
  return item.position;
}

template <typename Item>
Box3 boxOf(const std::vector<Item>& items, Range range) {
  Box3 box;
  for (std::uint32_t i = range.first; i < range.second; ++i) box.add(positionOf(items[i]));
  return box;
}

template <typename Item>
void halve(std::vector<Item>& items, Range range, std::size_t leafSize, int times,
           std::vector<Range>& out) {
  const std::uint32_t count = range.second - range.first;
  if (times == 0 || count <= leafSize) {
    out.push_back(range);
    return;
  }
  const Vec3 side = boxOf(items, range).extent();
  const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
  const auto begin = items.begin() + range.first;
  std::nth_element(begin, begin + count / 2, begin + count, [&](const Item& a, const Item& b) {
    const double x = a.position[axis], y = b.position[axis];
    return x < y || (x == y && a.index < b.index);
  });
  const std::uint32_t middle = range.first + count / 2;
  const Range halves[2] = {{range.first, middle}, {middle, range.second}};
  std::vector<Range> parts[2];
  forParts(2, count,
           [&](std::size_t h) { halve(items, halves[h], leafSize, times - 1, parts[h]); });
  for (const std::vector<Range>& some : parts) out.insert(out.end(), some.begin(), some.end());
}

template <typename Item>
Ball ballOf(const std::vector<Item>& items, double reach, Range range) {
  Ball ball{.center = boxOf(items, range).center()};
  double squared = 0;
  for (std::uint32_t i = range.first; i < range.second; ++i)
    squared = std::max(squared, squaredNorm(positionOf(items[i]) - ball.center));
  ball.radius = std::sqrt(squared) + reach;
  return ball;
}

template <typename Item>
BallTree::Node makeNode(const std::vector<Item>& items, double reach, Range range,
                        std::uint32_t depth) {
  BallTree::Node node;
  node.ball = ballOf(items, reach, range);
  node.begin = range.first;
  node.end = range.second;
  node.depth = depth;
  return node;
}

}  // namespace

// Level by level: the nodes of one are split side by side.
BallTree::BallTree(const Points& points, double reach, std::size_t leafSize, int halvings) {
  const auto count = static_cast<std::uint32_t>(points.size());
  if (count == 0) return;
  std::vector<Item> items(count);
  for (std::uint32_t i = 0; i < count; ++i) items[i] = {points[i], i};
  nodes_.push_back(makeNode(items, reach, {0, count}, 0));
  for (std::size_t begin = 0; begin < nodes_.size();) {
    const std::size_t end = nodes_.size();
    std::vector<std::vector<Node>> children(end - begin);
    parallelBlocks(end - begin, std::clamp<std::size_t>((end - begin) / 64, 1, 64),
                   [&](std::size_t first, std::size_t last) {
                     std::vector<Range> parts;
                     for (std::size_t n = first; n < last; ++n) {
                       const Node& node = nodes_[begin + n];
                       if (node.count() <= leafSize) continue;
                       parts.clear();
                       halve(items, {node.begin, node.end}, leafSize, halvings, parts);
                       children[n].resize(parts.size());
                       forParts(parts.size(), node.count(), [&](std::size_t c) {
                         children[n][c] = makeNode(items, reach, parts[c], node.depth + 1);
                       });
                     }
                   });
    for (std::size_t n = 0; n < children.size(); ++n) {
      nodes_[begin + n].firstChild = static_cast<std::uint32_t>(nodes_.size());
      nodes_[begin + n].children = static_cast<std::uint32_t>(children[n].size());
      nodes_.insert(nodes_.end(), children[n].begin(), children[n].end());
    }
    begin = end;
  }
  order_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) order_[i] = items[i].index;
}

// Not from the old balls: rounding would tell by which way they came.
BallTree BallTree::about(const Points& points, double reach) const {
  BallTree out = *this;
  Points ordered(points.size());
  for (std::size_t i = 0; i < ordered.size(); ++i) ordered[i] = points[order_[i]];
  parallelBlocks(out.nodes_.size(), 1, [&](std::size_t n, std::size_t) {
    Node& node = out.nodes_[n];
    node.ball = ballOf(ordered, reach, {node.begin, node.end});
  });
  return out;
}

}  // namespace innermap
