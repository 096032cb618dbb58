#include "mesh/detail/local_triangles.h"

namespace innermap {
namespace {

constexpr int kLeafSize = 4;

template <typename T>
std::vector<T> inOrder(const std::vector<T>& values, const std::vector<int>& order) {
  std::vector<T> out;
  out.reserve(order.size());
  for (const int i : order) out.push_back(values[i]);
  return out;
}

}  // namespace

LocalTriangles::LocalTriangles(const Points& vertices, const std::vector<Triangle>& triangles)
    : given(triangles.size()) {
  Box3 box;
  std::vector<int> finite;
  finite.reserve(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto [i, j, k] = triangles[t];
    if (!isFinite(vertices[i]) || !isFinite(vertices[j]) || !isFinite(vertices[k])) continue;
    finite.push_back(static_cast<int>(t));
    for (const int v : triangles[t]) box.add(vertices[v]);
  }
  frame = LocalFrame(box);
  std::vector<Box3> around(finite.size());
  const auto local = [&](int t) -> Corners {
    const auto [i, j, k] = triangles[t];
    return {frame.toLocal(vertices[i]), frame.toLocal(vertices[j]), frame.toLocal(vertices[k])};
  };
  for (std::size_t i = 0; i < finite.size(); ++i) {
    const Corners t = local(finite[i]);
    for (const Vec3& corner : {t.a, t.b, t.c}) around[i].add(corner);
  }
  bvh = buildBvh(around, kLeafSize);
  boxes = inOrder(around, bvh.order);
  index = inOrder(finite, bvh.order);
  bvh.order = {};
  corners.reserve(index.size());
  for (const int t : index) corners.push_back(local(t));
}

}  // namespace innermap
