#include "mesh/detail/ray_crossings.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/orientation.h"
#include "mesh/connectivity.h"

namespace innermap {
namespace {

// Shewchuk's A of orient2d, and what products that underflow may lose.
constexpr double kBound = (3 + 16 * 0x1.0p-53) * 0x1.0p-53, kUnderflow = 1e-300;

int numberOf(Sign s) { return static_cast<int>(s); }

// On which side of the edge from a to b the ray runs by, seen along the x axis: never on the edge,
// as it stands aside by some y and much less z. Zero for an edge along the axis.
Sign sideOf(const Vec3& a, const Vec3& b, const Vec3& p) {
  const double y = b.y - a.y, z = b.z - a.z;
  const double one = y * (p.z - a.z), two = z * (p.y - a.y);
  const double turned = one - two;
  if (std::abs(turned) > kBound * (std::abs(one) + std::abs(two)) + kUnderflow)
    return turned > 0 ? Sign::positive : Sign::negative;
  std::uint64_t exact = 0;
  const Sign sign = turn(a, b, p, 0, exact);
  if (sign != Sign::zero) return sign;
  if (a.z != b.z) return a.z < b.z ? Sign::negative : Sign::positive;
  if (a.y != b.y) return a.y < b.y ? Sign::positive : Sign::negative;
  return Sign::zero;
}

// 1 where the ray from p along the axis, forward or back, leaves by the triangle, -1 where it
// enters; undecided is passed on.
Sign crossing(const LocalTriangles::Corners& t, const Vec3& p, bool forward) {
  const Sign side = sideOf(t.a, t.b, p);
  if (side == Sign::zero || side == Sign::undecided) return side;
  for (const Sign other : {sideOf(t.b, t.c, p), sideOf(t.c, t.a, p)}) {
    if (other == Sign::undecided) return other;
    if (other != side) return Sign::zero;
  }
  const Sign out = forward ? side : opposite(side);
  const auto [low, high] = std::minmax({t.a.x, t.b.x, t.c.x});
  if (forward ? p.x < low : p.x > high) return out;
  std::uint64_t exact = 0;
  const Sign above = orientation(t.a, t.b, t.c, p, exact);
  if (above == Sign::undecided) return above;
  return above == opposite(out) ? out : Sign::zero;
}

bool mayMeet(const Bvh::Node& node, const Vec3& p, bool forward) {
  return node.lower[1] <= p.y && p.y <= node.upper[1] && node.lower[2] <= p.z &&
         p.z <= node.upper[2] && (forward ? p.x <= node.upper[0] : p.x >= node.lower[0]);
}

}  // namespace

bool isBalanced(const std::vector<Triangle>& triangles) {
  bool balanced = true;
  forEachEdge(sortedEdges(triangles), [&](const EdgeUse* begin, const EdgeUse* end) {
    int sum = 0;
    for (const EdgeUse* use = begin; use != end; ++use) sum += use->forward ? 1 : -1;
    if (sum != 0) balanced = false;
  });
  return balanced;
}

std::optional<int> rayCrossings(const LocalTriangles& triangles, const Vec3& p) {
  const Bvh& bvh = triangles.bvh;
  if (bvh.nodes.empty()) return 0;
  const bool forward = p.x > 0;  // the shorter way out
  int sum = 0;
  std::array<int, Bvh::kMaxDepth + 2> stack;
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const Bvh::Node& node = bvh.nodes[stack[--top]];
    if (!mayMeet(node, p, forward)) continue;
    if (!node.leaf()) {
      stack[top++] = node.first + 1;
      stack[top++] = node.first;
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
      const Sign out = crossing(triangles.corners[i], p, forward);
      if (out == Sign::undecided) return {};
      sum += numberOf(out);
    }
  }
  return sum;
}

}  // namespace innermap
