#include "innermap/mesh/check.h"

#include <algorithm>
#include <cstdint>
#include <tuple>

#include "core/disjoint_sets.h"
#include "innermap/core/run.h"
#include "mesh/detail/clean_triangles.h"
#include "mesh/detail/orientation.h"
#include "mesh/detail/topology.h"

namespace innermap {
namespace {

// Corners 3 t + c of the triangles, united where triangles share an edge.
DisjointSets unitedCorners(const std::vector<Triangle>& triangles,
                           const std::vector<EdgeUse>& edges) {
  DisjointSets sets(3 * triangles.size());
  forEachEdge(edges, [&](const EdgeUse* begin, const EdgeUse* end) {
    const auto cornerAt = [](const EdgeUse& use, bool low) {
      return 3 * use.triangle + (low == use.forward ? use.corner : (use.corner + 1) % 3);
    };
    for (const EdgeUse* use = begin + 1; use < end; ++use) {
      sets.unite(cornerAt(*begin, true), cornerAt(*use, true));
      sets.unite(cornerAt(*begin, false), cornerAt(*use, false));
    }
  });
  return sets;
}

std::vector<int> verticesOfSeveralFans(const std::vector<Triangle>& triangles,
                                       const std::vector<EdgeUse>& edges, std::size_t vertices) {
  DisjointSets corners = unitedCorners(triangles, edges);
  std::vector<int> fan(vertices, -1);
  std::vector<bool> several(vertices, false);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (hasRepeatedVertex(triangles[t])) continue;
    for (int c = 0; c < 3; ++c) {
      const int v = triangles[t][c], root = corners.find(static_cast<int>(3 * t) + c);
      if (fan[v] < 0) fan[v] = root;
      several[v] = several[v] || fan[v] != root;
    }
  }
  std::vector<int> result;
  for (std::size_t v = 0; v < vertices; ++v)
    if (several[v]) result.push_back(static_cast<int>(v));
  return result;
}

void checkEdges(const std::vector<EdgeUse>& edges, const Mesh& mesh, MeshReport& report) {
  std::vector<DirectedEdge> odd;
  forEachEdge(edges, [&](const EdgeUse* begin, const EdgeUse* end) {
    const std::ptrdiff_t uses = end - begin;
    if (uses % 2 == 1)
      odd.push_back(begin->forward ? DirectedEdge{begin->low, begin->high}
                                   : DirectedEdge{begin->high, begin->low});
    if (uses > 2) report.nonManifoldEdges.push_back({begin->low, begin->high});
    if (uses == 2 && begin[0].forward == begin[1].forward) ++report.inconsistentEdges;
  });
  for (std::vector<int>& vertices : traceLoops(odd, false)) {
    BoundaryLoop loop;
    for (std::size_t k = 0; k < vertices.size(); ++k)
      loop.length +=
          norm(mesh.vertices[vertices[(k + 1) % vertices.size()]] - mesh.vertices[vertices[k]]);
    loop.vertices = std::move(vertices);
    report.boundaryLoops.push_back(std::move(loop));
  }
  report.closed = report.boundaryLoops.empty();
}

void checkTriangles(const Mesh& mesh, MeshReport& report) {
  const double least = 1e-12 * report.box.diagonal();
  // (sorted vertices, triangle, even permutation of the sorted vertices)
  std::vector<std::tuple<Triangle, int, bool>> keys;
  keys.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const int index = static_cast<int>(t);
    const Vec3 &a = mesh.vertices[mesh.triangles[t][0]], &b = mesh.vertices[mesh.triangles[t][1]],
               &c = mesh.vertices[mesh.triangles[t][2]];
    const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
    const double twiceArea = 2 * norm(areaVector(mesh, index));
    const bool repeated = hasRepeatedVertex(mesh.triangles[t]);
    if (repeated || !(twiceArea > least * longest)) report.degenerateTriangles.push_back(index);
    if (repeated) continue;
    const Triangle& j = mesh.triangles[t];
    Triangle sorted = j;
    std::sort(sorted.begin(), sorted.end());
    const auto lowest = std::min_element(j.begin(), j.end()) - j.begin();
    keys.emplace_back(sorted, index, j[(lowest + 1) % 3] == sorted[1]);
  }
  std::sort(keys.begin(), keys.end());
  bool seen[2] = {false, false};
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto& [vertices, triangle, even] = keys[i];
    if (i == 0 || vertices != std::get<0>(keys[i - 1])) seen[0] = seen[1] = false;
    if (seen[even])
      report.duplicateTriangles.push_back(triangle);
    else if (seen[!even])
      report.oppositeTriangles.push_back(triangle);
    seen[even] = true;
  }
  std::sort(report.duplicateTriangles.begin(), report.duplicateTriangles.end());
  std::sort(report.oppositeTriangles.begin(), report.oppositeTriangles.end());
}

void checkComponents(const Mesh& mesh, MeshReport& report) {
  DisjointSets sets(mesh.vertices.size());
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const Triangle& t : mesh.triangles)
    for (const int v : t) {
      sets.unite(t[0], v);
      used[v] = true;
    }
  for (std::size_t v = 0; v < used.size(); ++v) {
    const int vertex = static_cast<int>(v);
    if (!used[v]) report.looseVertices.push_back(vertex);
    if (used[v] && sets.find(vertex) == vertex) ++report.components;
  }
}

// Of the surface cut apart where parts only touch in a vertex: every fan has its own vertex.
int genusOf(const std::vector<Triangle>& triangles, const std::vector<EdgeUse>& edges) {
  DisjointSets fans = unitedCorners(triangles, edges), parts(triangles.size());
  std::int64_t euler = 0, components = 0;
  std::vector<DirectedEdge> boundary;
  forEachEdge(edges, [&](const EdgeUse* begin, const EdgeUse* end) {
    --euler;
    for (const EdgeUse* use = begin + 1; use < end; ++use)
      parts.unite(begin->triangle, use->triangle);
    if ((end - begin) % 2 == 1)
      boundary.push_back({fans.find(3 * begin->triangle + begin->corner),
                          fans.find(3 * begin->triangle + (begin->corner + 1) % 3)});
  });
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (hasRepeatedVertex(triangles[t])) continue;
    ++euler;
    const int triangle = static_cast<int>(t);
    if (parts.find(triangle) == triangle) ++components;
    for (int c = 0; c < 3; ++c)
      if (fans.find(3 * triangle + c) == 3 * triangle + c) ++euler;
  }
  const std::int64_t loops = static_cast<std::int64_t>(traceLoops(boundary, false).size());
  return static_cast<int>((2 * components - euler - loops) / 2);
}

// Volume and genus, with seams joined. The volume is that with the remaining loops capped as repair
// does, but oriented as in the file.
void checkSolid(const Mesh& mesh, MeshReport& report) {
  const std::vector<Triangle> joined =
      joinedTriangles(mesh.vertices, mesh.triangles, &report.seamEdges);
  const std::vector<EdgeUse> edges = sortedEdges(joined);
  report.genus = genusOf(joined, edges);
  const Vec3 center = boundingBox(mesh).center();
  double volume = 6 * signedVolume(mesh);
  for (const std::vector<int>& loop : traceLoops(cappingEdges(edges), true)) {
    ++report.openLoops;
    const Vec3 apex = weightedSum(mesh.vertices, loopCentroid(mesh.vertices, loop));
    for (std::size_t k = 0; k < loop.size(); ++k)
      volume += coneVolume6(center, mesh.vertices[loop[k]],
                            mesh.vertices[loop[(k + 1) % loop.size()]], apex);
  }
  report.volume = volume / 6;
  report.outward = report.volume >= 0;
}

void checkCrossings(const Mesh& mesh, const CheckSettings& settings, MeshReport& report) {
  const auto before = [](const Crossing& a, const Crossing& b) {
    return a.first != b.first ? a.first < b.first : a.second < b.second;
  };
  // A heap with the last of the listed ones on top: memory stays bounded whatever their number.
  std::vector<Crossing>& listed = report.crossings;
  const auto visit = [&](const Crossing& crossing) {
    ++report.selfIntersections;
    if (listed.size() >= settings.listed) {
      if (listed.empty() || !before(crossing, listed.front())) return;
      std::pop_heap(listed.begin(), listed.end(), before);
      listed.pop_back();
    }
    listed.push_back(crossing);
    std::push_heap(listed.begin(), listed.end(), before);
  };
  forEachSelfIntersection(mesh.vertices, mesh.triangles, visit);
  std::sort(listed.begin(), listed.end(), before);
}

// As repair() finds it.
void checkSides(const Mesh& mesh, MeshReport& report) {
  const std::vector<Triangle> joined = joinedTriangles(mesh.vertices, mesh.triangles);
  std::vector<Triangle> kept;
  for (const int t : cleanTriangles(joined).kept) kept.push_back(joined[t]);
  report.oneSidedEdges = orient(mesh.vertices, kept, sortedEdges(kept)).conflicts;
}

}  // namespace

MeshReport checkMesh(const Mesh& mesh, const CheckSettings& settings) {
  validate(mesh);
  reportProgress("checking", 0);
  MeshReport report;
  report.vertices = mesh.vertices.size();
  report.triangles = mesh.triangles.size();
  report.polygons =
      mesh.polygonStart.empty() ? mesh.triangles.size() : mesh.polygonStart.size() - 1;
  report.box = boundingBox(mesh);
  report.area = surfaceArea(mesh);

  throwIfCancelled();
  const std::vector<EdgeUse> edges = sortedEdges(mesh.triangles);
  checkEdges(edges, mesh, report);
  checkTriangles(mesh, report);
  report.nonManifoldVertices = verticesOfSeveralFans(mesh.triangles, edges, mesh.vertices.size());
  checkComponents(mesh, report);
  throwIfCancelled();
  checkSolid(mesh, report);
  checkSides(mesh, report);
  reportProgress("checking", 0.5);
  if (settings.selfIntersections) checkCrossings(mesh, settings, report);
  reportProgress("checking", 1);
  return report;
}

std::uint64_t checkMemory(const Mesh& mesh) {
  // Edges, fans and the tree of boxes; measured at about 300 bytes a triangle.
  return 350 * mesh.triangles.size() + 100 * mesh.vertices.size();
}

}  // namespace innermap
