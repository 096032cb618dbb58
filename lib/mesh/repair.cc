#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/mesh/check.h"
#include "mesh/detail/clean_triangles.h"
#include "mesh/detail/orientation.h"
#include "mesh/detail/shells.h"
#include "mesh/detail/topology.h"

namespace innermap {
namespace {

// Of the volume over area times diagonal: what rounding may leave of nothing, and some more.
constexpr double kLeastThickness = 1e-12;

struct ShellEdge {
  int shell;
  DirectedEdge edge;
};

// The edges that caps need, shell by shell: each shell is closed by itself.
std::vector<ShellEdge> cappingEdgesOfShells(const ClosedShells& shells) {
  std::vector<ShellEdge> open;
  std::vector<std::array<int, 2>> uses;  // shell, direction
  forEachEdge(sortedEdges(shells.triangles), [&](const EdgeUse* begin, const EdgeUse* end) {
    uses.clear();
    for (const EdgeUse* use = begin; use != end; ++use)
      uses.push_back({shells.shell[use->triangle], use->forward ? 1 : -1});
    std::sort(uses.begin(), uses.end());
    for (std::size_t i = 0; i < uses.size();) {
      const int shell = uses[i][0];
      int net = 0;
      for (; i < uses.size() && uses[i][0] == shell; ++i) net += uses[i][1];
      for (; net > 0; --net) open.push_back({shell, {begin->high, begin->low}});
      for (; net < 0; ++net) open.push_back({shell, {begin->low, begin->high}});
    }
  });
  std::stable_sort(open.begin(), open.end(),
                   [](const ShellEdge& a, const ShellEdge& b) { return a.shell < b.shell; });
  return open;
}

// closed_ holds what is known of the solid, with the vertices of seams joined: first the kept
// triangles, oriented, then the caps. The mesh handed out has the file's own vertices again.
class Repair {
 public:
  explicit Repair(const Mesh& mesh) : mesh_(mesh) {}

  RepairedMesh run() {
    reportProgress("repairing", 0);
    clean();
    reportProgress("repairing", 0.3);
    orientTriangles();
    reportProgress("repairing", 0.5);
    cap();
    reportProgress("repairing", 0.7);
    turnInverted();
    requireInside();
    build();
    reportProgress("repairing", 1);
    return std::move(result_);
  }

 private:
  void note(std::size_t count, const char* one, const char* many) {
    if (count > 0) result_.notes.push_back(fmt::format("{} {}", count, count == 1 ? one : many));
  }

  [[noreturn]] void hasNoInside(const std::string& why) const {
    throw DataError(fmt::format("{}: has no inside, {}; give a mesh that bounds a solid",
                                mesh_.name.empty() ? "mesh" : mesh_.name, why));
  }

  void clean() {
    std::vector<bool> used(mesh_.vertices.size(), false);
    for (const Triangle& t : mesh_.triangles)
      for (const int v : t) used[v] = true;
    note(static_cast<std::size_t>(std::count(used.begin(), used.end(), false)),
         "loose vertex ignored", "loose vertices ignored");
    std::size_t seams = 0;
    const std::vector<int> to = joinedVertices(mesh_.vertices, mesh_.triangles, &seams);
    note(seams, "edge closed by joining doubled vertices",
         "edges closed by joining doubled vertices");
    const std::vector<Triangle> joined = mapped(mesh_.triangles, to);
    const CleanTriangles cleaned = cleanTriangles(joined);
    note(cleaned.repeatedVertex, "triangle with a repeated vertex left out",
         "triangles with a repeated vertex left out");
    note(cleaned.duplicates, "duplicate triangle left out", "duplicate triangles left out");
    note(cleaned.oppositePairs, "pair of opposite triangles left out",
         "pairs of opposite triangles left out");
    if (cleaned.kept.empty()) hasNoInside("every triangle is degenerate or cancelled by another");
    kept_ = cleaned.kept;
    closed_.positions = mesh_.vertices;
    closed_.triangles.reserve(kept_.size());
    for (const int t : kept_) closed_.triangles.push_back(joined[t]);
  }

  void orientTriangles() {
    Orientation orientation =
        orient(mesh_.vertices, closed_.triangles, sortedEdges(closed_.triangles));
    if (orientation.conflicts > 0)
      hasNoInside(
          fmt::format("it is one-sided, as a Moebius strip is: no way of turning its "
                      "triangles makes all neighbours agree, not at {} of its edges",
                      orientation.conflicts));
    turned_ = std::move(orientation.turned);
    note(static_cast<std::size_t>(std::count(turned_.begin(), turned_.end(), true)),
         "triangle turned to agree with its neighbours",
         "triangles turned to agree with their neighbours");
    for (std::size_t t = 0; t < turned_.size(); ++t)
      closed_.triangles[t] = turnedIf(turned_[t], closed_.triangles[t]);
    closed_.shell = std::move(orientation.shell);
    closed_.shells = orientation.shells;
  }

  void cap() {
    const std::vector<ShellEdge> open = cappingEdgesOfShells(closed_);
    std::vector<DirectedEdge> edges;
    for (std::size_t i = 0; i < open.size();) {
      throwIfCancelled();
      const int shell = open[i].shell;
      edges.clear();
      for (; i < open.size() && open[i].shell == shell; ++i) edges.push_back(open[i].edge);
      for (const std::vector<int>& loop : traceLoops(edges, true)) capLoop(loop, shell);
    }
    note(static_cast<std::size_t>(result_.caps), "hole capped", "holes capped");
  }

  void capLoop(const std::vector<int>& loop, int shell) {
    ++result_.caps;
    if (loop.size() == 3) {
      addCapTriangle({loop[0], loop[1], loop[2]}, shell);
      return;
    }
    CapVertex center;
    center.weights = loopCentroid(mesh_.vertices, loop);
    const int apex = static_cast<int>(closed_.positions.size());
    closed_.positions.push_back(weightedSum(mesh_.vertices, center.weights));
    result_.capVertices.push_back(std::move(center));
    for (std::size_t k = 0; k < loop.size(); ++k)
      addCapTriangle({loop[k], loop[(k + 1) % loop.size()], apex}, shell);
  }

  void addCapTriangle(const Triangle& triangle, int shell) {
    closed_.triangles.push_back(triangle);
    closed_.shell.push_back(shell);
  }

  void turnInverted() {
    const std::vector<bool> inverted = invertedShells(closed_);
    const std::size_t count =
        static_cast<std::size_t>(std::count(inverted.begin(), inverted.end(), true));
    if (count == 0) return;
    if (count == inverted.size())
      result_.notes.push_back("the whole mesh was inside out and is turned");
    else
      note(count, "part was inside out and is turned", "parts were inside out and are turned");
    turned_.resize(closed_.triangles.size(), false);
    for (std::size_t t = 0; t < turned_.size(); ++t) {
      if (!inverted[closed_.shell[t]]) continue;
      turned_[t] = !turned_[t];
      closed_.triangles[t] = turnedIf(true, closed_.triangles[t]);
    }
  }

  void requireInside() const {
    Box3 box;
    for (const Triangle& t : closed_.triangles)
      for (const int v : t) box.add(closed_.positions[v]);
    const double size = box.diagonal(), cubed = size * size * size;
    if (!std::isfinite(cubed) || (size > 0 && cubed < std::numeric_limits<double>::min()))
      throw DataError(fmt::format("{}: has a diagonal of {:.3g}, too {} to compute with; scale it",
                                  mesh_.name.empty() ? "mesh" : mesh_.name, size,
                                  size > 1 ? "large" : "small"));
    const std::vector<double> volumes = shellVolumes(closed_);
    const double volume = std::accumulate(volumes.begin(), volumes.end(), 0.0);
    double area = 0;
    for (const Triangle& t : closed_.triangles) {
      const Vec3& origin = closed_.positions[t[0]];
      area += norm(cross(closed_.positions[t[1]] - origin, closed_.positions[t[2]] - origin)) / 2;
    }
    if (!(volume > kLeastThickness * area * size))
      hasNoInside(
          fmt::format("its surface, holes capped, encloses a volume of {:.3g} for a "
                      "diagonal of {:.3g}",
                      volume, size));
  }

  void build() {
    Mesh& out = result_.mesh;
    out.name = mesh_.name;
    out.vertices = std::move(closed_.positions);
    out.uvs = mesh_.uvs;
    const bool uvs = !mesh_.uvTriangles.empty();
    for (std::size_t i = 0; i < closed_.triangles.size(); ++i) {
      const int parent = i < kept_.size() ? kept_[i] : -1;
      result_.parent.push_back(parent);
      out.triangles.push_back(parent < 0 ? closed_.triangles[i]
                                         : turnedIf(turned_[i], mesh_.triangles[parent]));
      if (uvs)
        out.uvTriangles.push_back(parent < 0 ? Triangle{-1, -1, -1}
                                             : turnedIf(turned_[i], mesh_.uvTriangles[parent]));
    }
    out.colours = mesh_.colours;
    if (out.colours.empty()) return;
    for (const CapVertex& center : result_.capVertices) {
      std::array<double, 3> sum{};
      for (const auto& [vertex, weight] : center.weights)
        for (int c = 0; c < 3; ++c)
          sum[c] += weight * static_cast<double>(mesh_.colours[vertex][c]);
      out.colours.push_back(
          {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])});
    }
  }

  const Mesh& mesh_;
  RepairedMesh result_;
  ClosedShells closed_;
  std::vector<int> kept_;     // triangles of mesh_
  std::vector<bool> turned_;  // of closed_'s triangles, against the file
};

}  // namespace

RepairedMesh repair(const Mesh& mesh) {
  validate(mesh);
  return Repair(mesh).run();
}

Points repairedPositions(const RepairedMesh& repaired, const Points& vertices) {
  const std::size_t expected = repaired.mesh.vertices.size() - repaired.capVertices.size();
  if (vertices.size() != expected)
    throw DataError(fmt::format(
        "{}: has {} vertices, the positions given are {}; give positions "
        "of the same connectivity",
        repaired.mesh.name.empty() ? "mesh" : repaired.mesh.name, expected, vertices.size()));
  Points result = vertices;
  result.reserve(repaired.mesh.vertices.size());
  for (const CapVertex& center : repaired.capVertices)
    result.push_back(weightedSum(vertices, center.weights));
  return result;
}

}  // namespace innermap
