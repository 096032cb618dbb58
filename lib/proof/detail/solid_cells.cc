#include "proof/detail/solid_cells.h"

#include <algorithm>
#include <cmath>

#include "proof/detail/scale.h"

namespace innermap::proof {
namespace {

// Cells are taken larger by so much of the root's half edge: more than all rounding of positions.
constexpr double kMargin = 1e-12;

// Whether projections onto the axis lie apart: of the cube of that half edge about the origin, and
// of the triangle.
bool apart(const Vec3& axis, const std::array<Vec3, 3>& t, double half) {
  const double a = dot(axis, t[0]), b = dot(axis, t[1]), c = dot(axis, t[2]);
  const double reach = half * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
  return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
}

// Separating axes (Akenine-Moller, "Fast 3D Triangle-Box Overlap Testing", 2001). In doubt true.
bool meets(const std::array<Vec3, 3>& t, double half) {
  constexpr Vec3 kAxes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const Vec3& axis : kAxes)
    if (apart(axis, t, half)) return false;
  const Vec3 edges[3] = {t[1] - t[0], t[2] - t[1], t[0] - t[2]};
  if (apart(cross(edges[0], edges[1]), t, half)) return false;
  for (const Vec3& axis : kAxes)
    for (const Vec3& edge : edges)
      if (apart(cross(axis, edge), t, half)) return false;
  return true;
}

Points scaledPoints(const Mesh& mesh, double scale, const Vec3& center) {
  Points out;
  out.reserve(mesh.vertices.size());
  for (const Vec3& v : mesh.vertices) out.push_back(scale * v - center);
  return out;
}

}  // namespace

SolidCells::SolidCells(const Mesh& mesh)
    : scale_(proofScale(boundingBox(mesh))),
      center_(scale_ * boundingBox(mesh).center()),
      winding_(scaledPoints(mesh, scale_, center_), mesh.triangles) {
  const Vec3 extent = scale_ * boundingBox(mesh).extent();
  half_ = powerAbove(0.5 * std::max({extent.x, extent.y, extent.z}) + kMargin);
  const Points points = scaledPoints(mesh, scale_, center_);
  std::vector<Box3> boxes;
  for (const Triangle& t : mesh.triangles) {
    Box3 box;
    for (const int v : t) box.add(points[v]);
    boxes.push_back(box);
  }
  tree_ = buildBvh(boxes, 4);
  for (const int i : tree_.order) {
    const Triangle& t = mesh.triangles[i];
    triangles_.push_back({points[t[0]], points[t[1]], points[t[2]]});
  }
}

SolidCells::Cell SolidCells::local(CellKey key) const {
  const int level = levelOf(key);
  std::uint64_t place[3] = {};
  for (int l = level; l-- > 0;)
    for (int a = 0; a < 3; ++a) place[a] = place[a] << 1 | (key >> (3 * l + a) & 1);
  Cell out;
  out.half = std::ldexp(half_, -level);
  for (int a = 0; a < 3; ++a)
    out.center[a] = out.half * (2 * static_cast<double>(place[a]) + 1) - half_;
  return out;
}

ProofCell SolidCells::world(CellKey key) const {
  const Cell cell = local(key);
  return {(cell.center + center_) / scale_, cell.half / scale_};
}

bool SolidCells::meetsSurface(const Cell& cell) const {
  const double half = cell.half + kMargin * half_;
  std::array<int, Bvh::kMaxDepth + 2> stack;
  int top = 0;
  if (!tree_.nodes.empty()) stack[top++] = 0;
  while (top > 0) {
    const Bvh::Node& node = tree_.nodes[stack[--top]];
    bool outside = false;
    for (int a = 0; a < 3; ++a)
      outside =
          outside || node.lower[a] > cell.center[a] + half || node.upper[a] < cell.center[a] - half;
    if (outside) continue;
    if (!node.leaf()) {
      stack[top++] = node.first + 1;
      stack[top++] = node.first;
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
      const auto& [a, b, c] = triangles_[i];
      if (meets({a - cell.center, b - cell.center, c - cell.center}, half)) return true;
    }
  }
  return false;
}

ChildLanes SolidCells::children(const OpenCell& parent) const {
  if (parent.inside) return {0xff, 0xff};
  ChildLanes out;
  unsigned free = 0;  // no triangle meets them
  for (int lane = 0; lane < static_cast<int>(kLanes); ++lane) {
    const unsigned bit = 1u << lane;
    const Cell cell = local(childOf(parent.key, lane));
    if (meetsSurface(cell)) {
      out.alive |= bit;
      continue;
    }
    // Two such cells with a common face lie on the same side.
    bool inside = false, known = false;
    for (const int other : {lane ^ 1, lane ^ 2, lane ^ 4})
      if (free >> other & 1) {
        known = true;
        inside = out.inside >> other & 1;
      }
    // Winding numbers of closed meshes are whole.
    if (!known) inside = winding_.wholeAt(cell.center) != 0;
    free |= bit;
    if (inside) {
      out.alive |= bit;
      out.inside |= bit;
    }
  }
  return out;
}

void SolidCells::sets(CellKey parent, LaneSets& out) const {
  // Up to their mirror images about the centre these are all corners.
  constexpr int kSigns[4][3] = {{1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {-1, 1, 1}};
  for (int lane = 0; lane < static_cast<int>(kLanes); ++lane) {
    const Cell cell = local(childOf(parent, lane));
    const Vec3 center = cell.center + center_;
    const double off = std::max({std::abs(center.x), std::abs(center.y), std::abs(center.z)});
    const double half = cell.half + kMargin * half_ + 1e-15 * off;
    for (int a = 0; a < 3; ++a) {
      out.center[a][lane] = center[a];
      for (int i = 0; i < 4; ++i) out.vertex[i][a][lane] = kSigns[i][a] * half;
    }
    out.slack[lane] = 0;
    out.radius[lane] = std::sqrt(3.0) * half * (1 + 1e-14);
  }
}

}  // namespace innermap::proof
