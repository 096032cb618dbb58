// Binary bounding volume hierarchy by the surface area heuristic; what searches among triangles and
// among cells stand on.
#pragma once

#include <vector>

#include "innermap/core/vec3.h"

namespace innermap {

// Coordinates about the centre of a box, scaled by a power of two to about one: distances keep
// their precision far from the origin, and squares neither overflow nor vanish.
struct LocalFrame {
  Vec3 center;
  double scale = 1, inverse = 1;

  LocalFrame() = default;
  explicit LocalFrame(const Box3& box);

  Vec3 toLocal(const Vec3& p) const { return scale * (p - center); }
  Vec3 toWorld(const Vec3& p) const { return center + inverse * p; }
};

struct Bvh {
  // Boxes are rounded outward to float. A node is a leaf when count > 0: its items are
  // order[first .. first + count). Otherwise its children are nodes first and first + 1.
  struct Node {
    float lower[3], upper[3];
    int first = 0, count = 0;

    bool leaf() const { return count > 0; }

    double squaredDistance(const Vec3& p) const {
      const double dx = std::max({0.0, lower[0] - p.x, p.x - upper[0]});
      const double dy = std::max({0.0, lower[1] - p.y, p.y - upper[1]});
      const double dz = std::max({0.0, lower[2] - p.z, p.z - upper[2]});
      return dx * dx + dy * dy + dz * dz;
    }
    bool overlaps(const Node& other) const {
      for (int a = 0; a < 3; ++a) {
        if (lower[a] > other.upper[a] || other.lower[a] > upper[a]) return false;
      }
      return true;
    }
  };

  // No path from the root is longer, so that traversals have stacks of fixed size.
  static constexpr int kMaxDepth = 96;

  std::vector<Node> nodes;  // root first; empty when there are no items; parents before children
  std::vector<int> order;   // item indices
};

// Items are given by their boxes, in a LocalFrame. Leaves hold at most leafSize items. The tree
// depends on the boxes alone, not on the number of threads.
Bvh buildBvh(const std::vector<Box3>& boxes, int leafSize);

}  // namespace innermap
