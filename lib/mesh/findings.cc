// What the numbers of a MeshReport mean for a map, in words.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "innermap/mesh/check.h"

namespace innermap {
namespace {

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

class Findings {
 public:
  void add(const char* name, std::size_t count, std::string what, const char* meaning) {
    if (count > 0) list_.push_back({name, count, std::move(what), meaning});
  }
  std::vector<Finding> take() { return std::move(list_); }

 private:
  std::vector<Finding> list_;
};

void addSolid(const MeshReport& report, Findings& out) {
  const double size = report.box.diagonal(), cubed = size * size * size;
  const bool computable = std::isfinite(cubed) && (size == 0 || cubed > 1e-300);
  out.add("not_computable", computable ? 0 : 1,
          fmt::format("the diagonal is {:.3g}, too {} to compute with", size,
                      size > 1 ? "large" : "small"),
          "the mesh is refused; scale it");
  const bool hollow = computable && !(std::abs(report.volume) > 1e-12 * report.area * size);
  out.add("no_inside", hollow ? 1 : 0,
          fmt::format("the volume enclosed is {:.3g}, nothing for an area of {:.3g}", report.volume,
                      report.area),
          "there is no solid to map; give a mesh that bounds one");
  out.add("one_sided", report.oneSidedEdges,
          counted(report.oneSidedEdges, "edge where", "edges where") +
              " no orientation agrees: the surface has one side, as a Moebius strip",
          "there is no inside to map; give a mesh that bounds one");
  std::string crossings = counted(report.selfIntersections, "pair of triangles that passes",
                                  "pairs of triangles that pass") +
                          " through each other";
  if (!report.crossings.empty()) {
    const Crossing& c = report.crossings.front();
    crossings += fmt::format(", the first at ({:.6g}, {:.6g}, {:.6g}), triangles {} and {}",
                             c.place.x, c.place.y, c.place.z, c.first, c.second);
  }
  out.add("self_intersections", report.selfIntersections, crossings,
          "between unrelated meshes innermap maps its outer surface (--outer writes it); between "
          "poses of one mesh, overlapping parts become one solid by their winding number, and no "
          "map onto it is one-to-one there");
}

void addBoundary(const MeshReport& report, Findings& out) {
  if (report.boundaryLoops.empty()) return;
  const BoundaryLoop& longest = *std::max_element(
      report.boundaryLoops.begin(), report.boundaryLoops.end(),
      [](const BoundaryLoop& a, const BoundaryLoop& b) { return a.length < b.length; });
  std::string what =
      fmt::format("{}, the longest {:.3g} long with {} edges at vertex {}",
                  counted(report.boundaryLoops.size(), "boundary loop", "boundary loops"),
                  longest.length, longest.vertices.size(), longest.vertices.front());
  if (report.seamEdges > 0)
    what += fmt::format("; {} left when doubled vertices are joined", report.openLoops);
  out.add("boundary_loops", report.boundaryLoops.size(), what,
          report.openLoops == 0
              ? "the solid is closed: all of them are seams, which are joined"
              : "the solid is closed by a cap over each loop, whose centre follows the loop in the "
                "target; a wide hole is better closed by hand");
}

void addOrientation(const MeshReport& report, Findings& out) {
  out.add("inconsistent_orientation", report.inconsistentEdges,
          counted(report.inconsistentEdges, "edge whose two triangles face",
                  "edges whose two triangles face") +
              " opposite ways",
          report.oneSidedEdges > 0
              ? "they cannot all be turned to agree"
              : "triangles are turned to agree with their neighbours before the solid is made");
  const double size = report.box.diagonal();
  const bool inverted = report.volume < -1e-12 * report.area * size;
  out.add("inside_out", inverted ? 1 : 0,
          fmt::format("the triangles face inward, the signed volume is {:.3g}", report.volume),
          "all triangles are turned before the solid is made; shading elsewhere may look wrong");
}

void addManifold(const MeshReport& report, Findings& out) {
  std::string edges =
      counted(report.nonManifoldEdges.size(), "edge", "edges") + " of three triangles or more";
  if (!report.nonManifoldEdges.empty())
    edges += fmt::format(", the first between vertices {} and {}", report.nonManifoldEdges[0][0],
                         report.nonManifoldEdges[0][1]);
  out.add("non_manifold_edges", report.nonManifoldEdges.size(), edges,
          "the solid is the region with a winding number over one half; walls inside it have no "
          "volume and are ignored");
  std::string vertices = counted(report.nonManifoldVertices.size(), "vertex", "vertices") +
                         " where separate fans of triangles touch";
  if (!report.nonManifoldVertices.empty())
    vertices += fmt::format(", the first {}", report.nonManifoldVertices[0]);
  out.add("non_manifold_vertices", report.nonManifoldVertices.size(), vertices,
          "parts of the solid touch in a point there; the map stays continuous across it");
}

void addTriangles(const MeshReport& report, Findings& out) {
  out.add("opposite_triangles", report.oppositeTriangles.size(),
          counted(report.oppositeTriangles.size(), "triangle", "triangles") +
              " on the back of another one",
          "such pairs enclose nothing and are left out");
  out.add("duplicate_triangles", report.duplicateTriangles.size(),
          counted(report.duplicateTriangles.size(), "triangle repeats", "triangles repeat") +
              " an earlier one",
          "repetitions are left out");
  std::string degenerate =
      counted(report.degenerateTriangles.size(), "triangle", "triangles") + " without area";
  if (!report.degenerateTriangles.empty())
    degenerate += fmt::format(", the first {}", report.degenerateTriangles[0]);
  out.add("degenerate_triangles", report.degenerateTriangles.size(), degenerate,
          "they carry no samples and do not change the solid");
}

void addParts(const MeshReport& report, Findings& out) {
  const std::size_t components = static_cast<std::size_t>(std::max(0, report.components));
  out.add("components", components > 1 ? components : 0,
          fmt::format("{} separate components", components),
          "the solid is their union, less the cavities; one map serves all of them, so parts that "
          "lie close but move apart need more source points");
  out.add(
      "seams", report.seamEdges,
      counted(report.seamEdges, "edge", "edges") + " along which vertices are doubled",
      "innermap joins them where their positions are equal; keep them together in the target too");
  out.add("loose_vertices", report.looseVertices.size(),
          counted(report.looseVertices.size(), "vertex", "vertices") + " that no triangle uses",
          "they are ignored");
}

}  // namespace

std::vector<Finding> findings(const MeshReport& report) {
  Findings out;
  addSolid(report, out);
  addBoundary(report, out);
  addManifold(report, out);
  addOrientation(report, out);
  addTriangles(report, out);
  addParts(report, out);
  return out.take();
}

}  // namespace innermap
