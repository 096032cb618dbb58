// A tree of balls about points, by halving at the median of the longest side.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "innermap/core/vec3.h"

namespace innermap {

struct Ball {
  Vec3 center;
  double radius = 0;
};

class BallTree {
 public:
  struct Node {
    Ball ball;                         // about all of its points
    std::uint32_t begin = 0, end = 0;  // of order()
    std::uint32_t firstChild = 0, children = 0;
    std::uint32_t depth = 0;
    bool leaf() const { return children == 0; }
    std::size_t count() const { return end - begin; }
  };

  // reach: radius of what a point stands for, >= 0. leafSize: most points of a leaf, >= 1.
  // halvings: of a node before it has children (1: two of them, 3: eight),
  // >= 1. Points must be finite and fewer than 2^31. Children stand behind their parents.
  // Deterministic.
  BallTree(const Points& points, double reach, std::size_t leafSize, int halvings);

  // The same halving, of the same points in other units or about another origin.
  BallTree about(const Points& points, double reach) const;

  bool empty() const { return nodes_.empty(); }
  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<std::uint32_t>& order() const { return order_; }  // indices of the points

 private:
  struct Item;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

}  // namespace innermap
