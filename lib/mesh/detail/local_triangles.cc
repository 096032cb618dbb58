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
  std::vector<Corners> places;
  places.reserve(finite.size());
  std::vector<Box3> around(finite.size());
  for (std::size_t n = 0; n < finite.size(); ++n) {
    const auto [i, j, k] = triangles[finite[n]];
    places.push_back(
        {frame.toLocal(vertices[i]), frame.toLocal(vertices[j]), frame.toLocal(vertices[k])});
    for (const Vec3& p : {places[n].a, places[n].b, places[n].c}) around[n].add(p);
  }
  bvh = buildBvh(around, kLeafSize);
  corners = inOrder(places, bvh.order);
  index = inOrder(finite, bvh.order);
  boxes = inOrder(around, bvh.order);
  bvh.order = {};
}

}  // namespace innermap
