#include <fmt/format.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <tuple>

#include "core/disjoint_sets.h"
#include "innermap/lattice/outer_surface.h"

namespace innermap {
namespace {

struct Side {
  int low, high, corner;  // corner: 3 triangle + the one from which it runs
  bool forward;
};

std::vector<Side> sortedSides(const std::vector<Triangle>& triangles) {
  std::vector<Side> sides(3 * triangles.size());
  for (std::size_t c = 0; c < sides.size(); ++c) {
    const Triangle& t = triangles[c / 3];
    const int a = t[c % 3], b = t[(c + 1) % 3];
    sides[c] = {std::min(a, b), std::max(a, b), static_cast<int>(c), a < b};
  }
  tbb::parallel_sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.corner) < std::tie(b.low, b.high, b.corner);
  });
  return sides;
}

int next(int corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

// Vertices at one place get one number.
std::vector<Triangle> welded(const Mesh& mesh) {
  std::vector<int> order(mesh.vertices.size()), name(mesh.vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  const auto key = [&](int i) {
    const Vec3& v = mesh.vertices[i];
    return std::tie(v.x, v.y, v.z);
  };
  tbb::parallel_sort(order.begin(), order.end(),
                     [&](int a, int b) { return key(a) < key(b) || (key(a) == key(b) && a < b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    name[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? name[order[i - 1]] : order[i];
  std::vector<Triangle> out;
  for (const Triangle& t : mesh.triangles) {
    const Triangle n{name[t[0]], name[t[1]], name[t[2]]};
    if (n[0] != n[1] && n[1] != n[2] && n[2] != n[0]) out.push_back(n);
  }
  return out;
}

std::string counted(int count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

}  // namespace

bool operator==(const SolidTopology& a, const SolidTopology& b) {
  return a.components == b.components && a.cavities == b.cavities && a.handles == b.handles;
}

std::string describe(const SolidTopology& t) {
  return counted(t.components, "component", "components") + ", " +
         counted(t.cavities, "cavity", "cavities") + ", " + counted(t.handles, "handle", "handles");
}

BoundaryTopology boundaryTopology(const Points& vertices, const std::vector<Triangle>& triangles) {
  BoundaryTopology result;
  const std::size_t count = triangles.size();
  if (count == 0) return result;
  const std::vector<Side> sides = sortedSides(triangles);
  DisjointSets shells(count);
  DisjointSets fans(3 * count);   // of corners
  std::vector<int> edgeTriangle;  // one for each edge
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    for (end = i + 1;
         end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high;
         ++end) {
    }
    edgeTriangle.push_back(sides[i].corner / 3);
    for (std::size_t k = i + 1; k < end; ++k)
      shells.unite(sides[i].corner / 3, sides[k].corner / 3);
    if (end - i == 1) {
      ++result.openEdges;
    } else if (end - i > 2 || sides[i].forward == sides[i + 1].forward) {
      ++result.nonManifoldEdges;
    } else {
      const int a = sides[i].corner, b = sides[i + 1].corner;
      fans.unite(a, next(b));
      fans.unite(next(a), b);
    }
  }
  const std::vector<int> shellOf = shells.representatives();
  std::vector<int> euler(triangles.size(), 0), fanCount(vertices.size(), 0);
  std::vector<double> volume(triangles.size(), 0);
  const Vec3 centre = vertices[triangles[0][0]];
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    ++euler[shellOf[t]];
    const auto at = [&](int k) { return vertices[triangles[t][k]] - centre; };
    volume[shellOf[t]] += dot(at(0), cross(at(1), at(2)));
    for (int k = 0; k < 3; ++k) {
      const int corner = static_cast<int>(3 * t) + k;
      if (fans.find(corner) != corner) continue;
      ++euler[shellOf[t]];
      ++fanCount[triangles[t][k]];
    }
  }
  for (const int t : edgeTriangle) --euler[shellOf[t]];
  for (const int fansHere : fanCount) result.nonManifoldVertices += fansHere > 1;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (shellOf[t] != static_cast<int>(t)) continue;
    result.solid.handles += 1 - euler[t] / 2;
    ++(volume[t] < 0 ? result.solid.cavities : result.solid.components);
  }
  return result;
}

SurfaceTopology surfaceTopology(const Solid& solid) {
  if (solid.overlaps() || solid.repaired().caps > 0) return {};
  const BoundaryTopology found =
      boundaryTopology(solid.surface().vertices, welded(solid.surface()));
  return {found.manifold(), found.solid};
}

}  // namespace innermap
