#include "transfer/cell_locator.h"

#include <algorithm>

#include "core/bvh.h"
#include "mesh/triangle_tree.h"

namespace innermap {
namespace {

constexpr int kLeaf = 8;
constexpr double kInside = 1e-12;  // of barycentric coordinates: faces belong to both sides
constexpr std::array<std::array<int, 3>, 4> kFaces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

std::array<double, 4> barycentricOf(const std::array<Vec3, 4>& c, const Vec3& p) {
  const Vec3 a = c[1] - c[0], b = c[2] - c[0], d = c[3] - c[0], q = p - c[0];
  const double volume = dot(a, cross(b, d));
  const double x = dot(q, cross(b, d)) / volume, y = dot(a, cross(q, d)) / volume,
               z = dot(a, cross(b, q)) / volume;
  return {1 - x - y - z, x, y, z};
}

double distanceOf(const std::array<Vec3, 4>& c, const Vec3& p) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& f : kFaces)
    best = std::min(best, closestOnTriangle(p, {c[f[0]], c[f[1]], c[f[2]]}).distance);
  return best;
}

}  // namespace

struct CellLocator::Implementation {
  LocalFrame frame;
  Bvh bvh;
  std::vector<std::array<Vec3, 4>> corners;  // local, in the order of the leaves
  std::vector<int> numbers;                  // likewise

  Implementation(const Points& vertices, const std::vector<Tetrahedron>& tets)
      : frame(boundingBox(vertices)) {
    std::vector<int> used;
    for (std::size_t t = 0; t < tets.size(); ++t)
      if (signedVolume(vertices, tets[t]) > 0) used.push_back(static_cast<int>(t));
    std::vector<Box3> boxes(used.size());
    const auto at = [&](int t, int k) { return frame.toLocal(vertices[tets[t][k]]); };
    for (std::size_t i = 0; i < used.size(); ++i)
      for (int k = 0; k < 4; ++k) boxes[i].add(at(used[i], k));
    bvh = buildBvh(boxes, kLeaf);
    for (const int i : bvh.order) {
      numbers.push_back(used[i]);
      corners.push_back({at(used[i], 0), at(used[i], 1), at(used[i], 2), at(used[i], 3)});
    }
  }

  // Number in the leaves' order, or -1.
  int containing(const Vec3& p) const {
    int found = -1;
    std::array<int, Bvh::kMaxDepth + 2> stack;
    int top = 0;
    stack[top++] = 0;
    while (top > 0) {
      const Bvh::Node& node = bvh.nodes[stack[--top]];
      if (node.squaredDistance(p) > 0) continue;
      if (!node.leaf()) {
        stack[top++] = node.first + 1;
        stack[top++] = node.first;
        continue;
      }
      for (int i = node.first; i < node.first + node.count; ++i) {
        if (found >= 0 && numbers[found] < numbers[i]) continue;
        const auto b = barycentricOf(corners[i], p);
        if (*std::min_element(b.begin(), b.end()) >= -kInside) found = i;
      }
    }
    return found;
  }

  int nearest(const Vec3& p, double& distance) const {
    int found = -1;
    distance = std::numeric_limits<double>::infinity();
    std::array<int, Bvh::kMaxDepth + 2> stack;
    int top = 0;
    stack[top++] = 0;
    while (top > 0) {
      const Bvh::Node& node = bvh.nodes[stack[--top]];
      if (node.squaredDistance(p) > distance * distance) continue;
      if (!node.leaf()) {
        const int first = node.first, second = node.first + 1;
        const bool swap =
            bvh.nodes[second].squaredDistance(p) < bvh.nodes[first].squaredDistance(p);
        stack[top++] = swap ? first : second;
        stack[top++] = swap ? second : first;
        continue;
      }
      for (int i = node.first; i < node.first + node.count; ++i) {
        const double d = distanceOf(corners[i], p);
        if (d < distance || (!(d > distance) && found >= 0 && numbers[i] < numbers[found])) {
          distance = d;
          found = i;
        }
      }
    }
    return found;
  }
};

CellLocator::CellLocator(const Points& vertices, const std::vector<Tetrahedron>& tetrahedra)
    : implementation_(std::make_shared<Implementation>(vertices, tetrahedra)) {}

CellPoint CellLocator::locate(const Vec3& world) const {
  const Implementation& tree = *implementation_;
  CellPoint out;
  if (tree.bvh.nodes.empty() || !isFinite(world)) return out;
  const Vec3 p = tree.frame.toLocal(world);
  int found = tree.containing(p);
  if (found < 0) {
    double distance = 0;
    found = tree.nearest(p, distance);
    if (found < 0) return out;
    out.distance = tree.frame.inverse * distance;
  }
  out.tetrahedron = tree.numbers[found];
  out.barycentric = barycentricOf(tree.corners[found], p);
  return out;
}

CellPoint clamped(CellPoint point) {
  double sum = 0;
  for (double& b : point.barycentric) sum += b = std::max(0.0, b);
  for (double& b : point.barycentric) b /= sum;
  return point;
}

Vec3 valueAt(const Points& values, const std::vector<Tetrahedron>& tetrahedra,
             const CellPoint& point) {
  Vec3 sum;
  for (int k = 0; k < 4; ++k)
    sum += point.barycentric[k] * values[tetrahedra[point.tetrahedron][k]];
  return sum;
}

}  // namespace innermap
