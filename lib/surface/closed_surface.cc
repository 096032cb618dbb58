#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/disjoint_sets.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/mesh/check.h"
#include "innermap/surface/correspond.h"
#include "mesh/connectivity.h"
#include "surface/detail/topology/nesting.h"

namespace innermap {
namespace {

constexpr double kNoVolume = 1e-9;  // of the diagonal cubed
constexpr std::size_t kNamedEdges = 5;

std::string nameOf(const Mesh& mesh) { return mesh.name.empty() ? "mesh" : mesh.name; }

// The first few edges by their vertices, "12-15, 15-20 and 3 more".
std::string named(const std::vector<std::array<int, 2>>& edges) {
  std::string text;
  for (std::size_t e = 0; e < std::min(edges.size(), kNamedEdges); ++e)
    text += fmt::format("{}{}-{}", e == 0 ? "" : ", ", edges[e][0], edges[e][1]);
  if (edges.size() > kNamedEdges) text += fmt::format(" and {} more", edges.size() - kNamedEdges);
  return text;
}

// The longest of the loops that caps close, and its first vertex.
std::pair<double, int> longestHole(const RepairedMesh& repaired) {
  const Points& at = repaired.mesh.vertices;
  const int firstApex = static_cast<int>(at.size() - repaired.capVertices.size());
  std::vector<double> fan(repaired.capVertices.size(), 0);
  std::pair<double, int> longest{-1, 0};
  for (std::size_t t = 0; t < repaired.parent.size(); ++t) {
    if (repaired.parent[t] >= 0) continue;
    const auto& [a, b, c] = repaired.mesh.triangles[t];
    double length = norm(at[b] - at[a]);
    if (c >= firstApex)
      length = fan[c - firstApex] += length;
    else
      length += norm(at[c] - at[b]) + norm(at[a] - at[c]);
    if (length > longest.first) longest = {length, a};
  }
  return longest;
}

// Works on the repaired mesh's triangles (those of repair(): kept, oriented, then the caps').
class ShellBuilder {
 public:
  ShellBuilder(const Mesh& mesh, const ClosedSurfaceSettings& settings)
      : mesh_(mesh), settings_(settings) {}

  SurfaceShells run() {
    repaired_ = repair(mesh_);
    joinVertices();
    requireManifold();
    if (repaired_.caps > 0 && !settings_.closeHoles) refuseHoles();
    reportProgress("taking the surface apart", 0);
    result_.caps = repaired_.caps;
    result_.notes = repaired_.notes;
    makeMesh();
    findFans();
    makeShells();
    reportProgress("taking the surface apart", 0.5);
    if (result_.shells.empty())
      throw DataError(nameOf(mesh_) + ": no part of it encloses anything; give a closed mesh");
    result_.parent = parentShells(result_.shells);
    reportProgress("taking the surface apart", 1);
    return std::move(result_);
  }

 private:
  void joinVertices() {
    const std::vector<int> to = joinedVertices(mesh_.vertices, mesh_.triangles);
    joined_ = repaired_.mesh.triangles;
    for (Triangle& t : joined_)
      for (int& v : t)
        if (v < static_cast<int>(to.size())) v = to[v];
  }

  // Looks at the mesh's own triangles: what caps would hide is named as it is in the file.
  void requireManifold() const {
    std::vector<Triangle> own;
    for (std::size_t t = 0; t < joined_.size(); ++t)
      if (repaired_.parent[t] >= 0) own.push_back(joined_[t]);
    std::vector<std::array<int, 2>> crowded, oneSided;
    forEachEdge(sortedEdges(own), [&](const EdgeUse* begin, const EdgeUse* end) {
      if (end - begin > 2)
        crowded.push_back({begin->low, begin->high});
      else if (end - begin == 2 && begin[0].forward == begin[1].forward)
        oneSided.push_back({begin->low, begin->high});
    });
    if (!crowded.empty())
      throw DataError(fmt::format(
          "{}: {} edge{} more than two triangles, between the vertices {} (counted from 0); "
          "separate the parts that meet there",
          nameOf(mesh_), crowded.size(), crowded.size() == 1 ? " has" : "s have", named(crowded)));
    if (!oneSided.empty())
      throw DataError(fmt::format(
          "{}: is one-sided, no orientation agrees at {} edge{}, between the vertices {} (counted "
          "from 0); give a mesh that bounds a solid",
          nameOf(mesh_), oneSided.size(), oneSided.size() == 1 ? "" : "s", named(oneSided)));
  }

  [[noreturn]] void refuseHoles() const {
    const auto [length, vertex] = longestHole(repaired_);
    throw DataError(fmt::format(
        "{}: is open, with {} hole{}, the longest {:.4g} around, at vertex {} (counted from 0); "
        "close {}, or consent to caps",
        nameOf(mesh_), repaired_.caps, repaired_.caps == 1 ? "" : "s", length, vertex,
        repaired_.caps == 1 ? "it" : "them"));
  }

  void makeMesh() {
    Mesh& out = result_.mesh;
    out = mesh_;
    out.vertices = repaired_.mesh.vertices;
    out.colours = repaired_.mesh.colours;
    result_.turned.assign(mesh_.triangles.size(), false);
    meshTriangle_.resize(joined_.size());
    bool changed = false;
    for (std::size_t t = 0; t < joined_.size(); ++t) {
      const int parent = repaired_.parent[t];
      const Triangle& triangle = repaired_.mesh.triangles[t];
      meshTriangle_[t] = parent >= 0 ? parent : static_cast<int>(out.triangles.size());
      changed |= parent < 0 || out.triangles[parent] != triangle;
      if (parent < 0) {
        out.triangles.push_back(triangle);
        if (!out.uvTriangles.empty()) out.uvTriangles.push_back({-1, -1, -1});
      } else if (out.triangles[parent] != triangle) {
        result_.turned[parent] = true;
        out.triangles[parent] = triangle;
        if (!out.uvTriangles.empty()) out.uvTriangles[parent] = repaired_.mesh.uvTriangles[t];
      }
    }
    result_.turned.resize(out.triangles.size(), false);
    if (changed) {
      out.polygonStart.clear();
      out.polygonCorners.clear();
    }
  }

  // Corners 3 t + k that are one vertex: those that edges of two triangles lead to. Parts of the
  // surface: triangles that such edges join.
  void findFans() {
    DisjointSets corners(3 * joined_.size()), parts(joined_.size());
    forEachEdge(sortedEdges(joined_), [&](const EdgeUse* begin, const EdgeUse* end) {
      if (end - begin != 2 || begin[0].forward == begin[1].forward)
        throw DataError(
            fmt::format("{}: caps do not close it, they meet other triangles at the "
                        "edge {}-{}; close the mesh by hand",
                        nameOf(mesh_), begin->low, begin->high));
      const int s = begin[0].side(), o = begin[1].side();
      corners.unite(s, next(o));
      corners.unite(next(s), o);
      parts.unite(begin[0].triangle, begin[1].triangle);
    });
    corner_ = corners.representatives();
    part_ = parts.representatives();
  }

  static int next(int side) { return side - side % 3 + (side + 1) % 3; }

  void makeShells() {
    std::vector<int> slot(joined_.size(), -1);  // of a part, by its first triangle
    std::vector<std::vector<int>> parts;
    for (std::size_t t = 0; t < joined_.size(); ++t) {
      int& s = slot[part_[t]];
      if (s < 0) {
        s = static_cast<int>(parts.size());
        parts.emplace_back();
      }
      parts[s].push_back(static_cast<int>(t));
    }
    std::stable_sort(parts.begin(), parts.end(),
                     [&](const std::vector<int>& a, const std::vector<int>& b) {
                       return meshTriangle_[a.front()] < meshTriangle_[b.front()];
                     });
    std::size_t empty = 0;
    local_.assign(corner_.size(), -1);
    result_.shellVertex.assign(result_.mesh.vertices.size(), {});
    for (const std::vector<int>& members : parts) {
      throwIfCancelled();
      ClosedSurface shell = makeShell(members);
      if (!enclosesSomething(shell)) {
        ++empty;
        continue;
      }
      addToMesh(members);
      result_.shells.push_back(std::move(shell));
    }
    if (empty > 0)
      result_.notes.push_back(fmt::format("{} that enclose{} nothing left out",
                                          empty == 1 ? "1 part" : fmt::format("{} parts", empty),
                                          empty == 1 ? "s" : ""));
    if (result_.splitVertices > 0)
      result_.notes.push_back(fmt::format("{} where parts touch split",
                                          result_.splitVertices == 1
                                              ? "1 vertex"
                                              : fmt::format("{} vertices", result_.splitVertices)));
  }

  ClosedSurface makeShell(const std::vector<int>& members) {
    ClosedSurface shell;
    shell.name = nameOf(mesh_);
    shell.triangles.reserve(members.size());
    std::vector<std::pair<int, int>> order;  // vertex of the mesh, corner that stands for the fan
    for (const int t : members)
      for (int k = 0; k < 3; ++k)
        if (corner_[3 * t + k] == 3 * t + k) order.emplace_back(joined_[t][k], 3 * t + k);
    std::sort(order.begin(), order.end());
    shell.vertices.reserve(order.size());
    for (const auto& [vertex, corner] : order) {
      local_[corner] = static_cast<int>(shell.vertices.size());
      shell.vertices.push_back(result_.mesh.vertices[vertex]);
    }
    for (const int t : members)
      shell.triangles.push_back(
          {local_[corner_[3 * t]], local_[corner_[3 * t + 1]], local_[corner_[3 * t + 2]]});
    const long euler =
        static_cast<long>(shell.vertices.size()) - static_cast<long>(members.size() / 2);
    shell.genus = static_cast<int>((2 - euler) / 2);
    return shell;
  }

  static bool enclosesSomething(const ClosedSurface& shell) {
    if (shell.vertices.size() < 4) return false;
    const double size = boundingBox(shell.vertices).diagonal();
    return std::abs(signedVolume(shell.vertices, shell.triangles)) > kNoVolume * size * size * size;
  }

  // The first fan of a vertex keeps it, others get one at the end.
  void addToMesh(const std::vector<int>& members) {
    Mesh& mesh = result_.mesh;
    const int shell = static_cast<int>(result_.shells.size());
    std::vector<int> numbers;
    for (const int t : members) {
      const int m = meshTriangle_[t];
      numbers.push_back(m);
      for (int k = 0; k < 3; ++k) {
        const int vertex = mesh.triangles[m][k], own = local_[corner_[3 * t + k]];
        ShellVertex& place = result_.shellVertex[vertex];
        if (place.shell < 0) place = {shell, own};
        if (place.shell == shell && place.vertex == own) continue;
        mesh.triangles[m][k] = furtherFan(vertex, {shell, own});
      }
    }
    result_.meshTriangle.push_back(std::move(numbers));
  }

  int furtherFan(int vertex, const ShellVertex& fan) {
    Mesh& mesh = result_.mesh;
    const int added = static_cast<int>(mesh.vertices.size());
    const auto [found, isNew] = further_.try_emplace({vertex, fan.shell, fan.vertex}, added);
    if (!isNew) return found->second;
    mesh.vertices.push_back(Vec3(mesh.vertices[vertex]));
    if (!mesh.colours.empty()) mesh.colours.push_back(std::array<float, 3>(mesh.colours[vertex]));
    result_.shellVertex.push_back(fan);
    mesh.polygonStart.clear();
    mesh.polygonCorners.clear();
    ++result_.splitVertices;
    return added;
  }

  const Mesh& mesh_;
  const ClosedSurfaceSettings& settings_;
  RepairedMesh repaired_;
  SurfaceShells result_;
  std::vector<Triangle> joined_;   // the repaired triangles, seams joined
  std::vector<int> meshTriangle_;  // of each, its number in result_.mesh
  std::vector<int> corner_;        // for each corner, the first one of its fan
  std::vector<int> part_;          // for each triangle, the first one of its part
  std::vector<int> local_;         // for each corner that is its fan's first: vertex of the shell
  std::map<std::array<int, 3>, int> further_;  // (vertex, shell, its vertex): where it was added
};

}  // namespace

SurfaceShells closedSurfaces(const Mesh& mesh, const ClosedSurfaceSettings& settings) {
  return ShellBuilder(mesh, settings).run();
}

}  // namespace innermap
