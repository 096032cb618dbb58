#include "surface/detail/refining/subdivide.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <unordered_map>

#include "innermap/core/run.h"
#include "innermap/mesh/check.h"
#include "mesh/triangle_tree.h"
#include "surface/detail/refining/coarse_to_fine.h"
#include "surface/detail/refining/locate.h"
#include "surface/detail/refining/pullback_energy.h"
#include "surface/detail/topology/adjacency.h"

namespace innermap {
namespace {

constexpr double kMargin = 0.8;  // of the tolerance: points between those looked at deviate more
constexpr int kRounds = 60;
constexpr int kUncrossings = 20;        // rounds that split what crosses
constexpr double kMostCrossing = 0.02;  // share of the triangles; more make the map dear to fit
// As many as there were at the fewest, and some, or a share of the triangles: where the map itself
// is at fault, splitting makes ever more. A few come and go before the last is gone.
constexpr double kMoreCrossing = 1.5, kSomeCrossing = 4, kSomeShare = 0.004;

std::uint64_t keyOf(int i, int j) {
  return static_cast<std::uint64_t>(std::min(i, j)) << 32 |
         static_cast<std::uint32_t>(std::max(i, j));
}

// Vertices halfway between two others, made when first asked for.
class Midpoints {
 public:
  template <typename Make>
  int between(int i, int j, const Make& make) {
    const auto [at, fresh] = made_.try_emplace(keyOf(i, j), -1);
    if (fresh) at->second = make();
    return at->second;
  }

 private:
  std::unordered_map<std::uint64_t, int> made_;
};

class Subdivision {
 public:
  Subdivision(const SplitShell& shell, const TargetMetric& target, SplitMesh& split,
              const SubdivideSettings& settings)
      : shell_(shell),
        surface_(shell.surface),
        image_(shell.image),
        target_(target),
        split_(split),
        settings_(settings),
        tree_(shell.target.vertices, shell.target.triangles),
        limit_(kMargin * settings.tolerance * boundingBox(shell.target.vertices).diagonal()) {}

  Subdivided run() {
    Subdivided out;
    const std::size_t before = surface_.vertices.size();
    std::vector<char> look(surface_.triangles.size(), 1);
    for (int round = 0; round < kRounds; ++round) {
      reportProgress("splitting the source", static_cast<double>(round) / kRounds);
      std::vector<char> marked = deviating(look);
      std::vector<std::pair<int, int>> edges =
          edgesToSplit(marked, [this](int t, int k) { return modelLength(t, k); });
      if (edges.empty() && mayUncross()) {
        marked = crossing();
        edges = edgesToSplit(marked, [this](int t, int k) { return imageLength(t, k); });
      }
      if (edges.empty()) break;
      if (outOfTime() || surface_.triangles.size() + 2 * edges.size() > settings_.triangles) {
        out.enough = false;
        break;
      }
      const int first = static_cast<int>(surface_.vertices.size());
      for (const auto& [t, k] : edges) splitEdge(t, k);
      look = relaxFrom(first);
      // Those that had to wait for a neighbour.
      for (std::size_t t = 0; t < marked.size(); ++t) look[t] = look[t] || marked[t];
    }
    out.added = surface_.vertices.size() - before;
    return out;
  }

 private:
  Vec3 onTarget(const Locator& locator, const Vec3& ray) const {
    const Located where = locator.find(ray);
    const std::array<double, 3> w = locator.barycentric(ray, where);
    const Triangle& t = shell_.target.triangles[where.triangle];
    Vec3 p;
    for (int k = 0; k < 3; ++k) p += w[k] * shell_.target.vertices[t[k]];
    return p;
  }

  // Of the triangles to look at (others keep what was found): those too far from the target.
  std::vector<char> deviating(const std::vector<char>& look) {
    const std::size_t triangles = surface_.triangles.size();
    positions_.resize(surface_.vertices.size());
    parallelBlocks(positions_.size(), 512, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v)
        positions_[v] = onTarget(target_.locator(), image_.place[v]);
    });
    std::vector<char> out(triangles, 0);
    parallelBlocks(triangles, 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t)
        if (look[t] && leavesTarget(static_cast<int>(t))) out[t] = 1;
    });
    markMissed(out);
    return out;
  }

  bool leavesTarget(int t) const {
    const Triangle& tri = surface_.triangles[t];
    const Vec3 &a = positions_[tri[0]], &b = positions_[tri[1]], &c = positions_[tri[2]];
    static const double kWeights[][3] = {
        {0.5, 0.5, 0},   {0, 0.5, 0.5},   {0.5, 0, 0.5},  {1. / 3, 1. / 3, 1. / 3},
        {0.6, 0.2, 0.2}, {0.2, 0.6, 0.2}, {0.2, 0.2, 0.6}};
    for (const auto& w : kWeights)
      if (!(tree_.closest(w[0] * a + w[1] * b + w[2] * c, limit_).distance < limit_)) return true;
    return false;
  }

  // Triangles that the target's vertices between their corners are too far from.
  void markMissed(std::vector<char>& marked) const {
    const Locator locator(surface_.triangles, image_);
    const Points& vertices = shell_.target.vertices;
    std::vector<int> missed(vertices.size(), -1);
    parallelBlocks(vertices.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const int t = locator.find(shell_.targetLayout.place[v]).triangle;
        const Triangle& tri = surface_.triangles[t];
        const TriangleTree own({positions_[tri[0]], positions_[tri[1]], positions_[tri[2]]},
                               {Triangle{0, 1, 2}});
        if (!(own.closest(vertices[v]).distance < limit_)) missed[v] = t;
      }
    });
    for (const int t : missed)
      if (t >= 0) marked[t] = 1;
  }

  // Flat triangles cut across what is thin. Smaller ones do not, unless the target crosses itself.
  bool mayUncross() {
    if (uncrossings_ == 0 &&
        !selfIntersections(shell_.target.vertices, shell_.target.triangles).empty())
      uncrossings_ = kUncrossings;
    return uncrossings_++ < kUncrossings;
  }

  // Triangles whose flat images pass through each other; none where these are so many, or become so
  // many, that the map itself is at fault.
  std::vector<char> crossing() {
    std::vector<char> out(surface_.triangles.size(), 0);
    for (const Crossing& c : selfIntersections(positions_, surface_.triangles))
      out[c.first] = out[c.second] = 1;
    const auto count = static_cast<double>(std::count(out.begin(), out.end(), 1));
    fewestCrossing_ = std::min(fewestCrossing_, count);
    const auto all = static_cast<double>(out.size());
    if (count > kMostCrossing * all ||
        count > kMoreCrossing * fewestCrossing_ + std::max(kSomeCrossing, kSomeShare * all))
      out.assign(out.size(), 0);
    return out;
  }

  // Of the edge opposite corner k, on the model space and on the target.
  double modelLength(int t, int k) const {
    return norm(image_.corner(surface_.triangles, t, (k + 2) % 3) -
                image_.corner(surface_.triangles, t, (k + 1) % 3));
  }
  double imageLength(int t, int k) const {
    const Triangle& tri = surface_.triangles[t];
    return norm(positions_[tri[(k + 2) % 3]] - positions_[tri[(k + 1) % 3]]);
  }

  // The longest edges of the marked triangles, no two of one triangle: (triangle, opposite corner).
  template <typename Length>
  std::vector<std::pair<int, int>> edgesToSplit(const std::vector<char>& marked,
                                                const Length& length) {
    neighbours_ = neighboursOf(surface_.triangles);
    struct Edge {
      double length;
      int triangle, corner;
    };
    std::vector<Edge> edges;
    for (int t = 0; t < static_cast<int>(marked.size()); ++t) {
      if (!marked[t]) continue;
      int longest = 0;
      for (int k = 1; k < 3; ++k)
        if (length(t, k) > length(t, longest)) longest = k;
      edges.push_back({length(t, longest), t, longest});
    }
    std::stable_sort(edges.begin(), edges.end(),
                     [](const Edge& x, const Edge& y) { return x.length > y.length; });
    std::vector<char> used(surface_.triangles.size(), 0);
    std::vector<std::pair<int, int>> out;
    for (const Edge& e : edges) {
      const int other = neighbours_[e.triangle][e.corner].triangle;
      if (used[e.triangle] || used[other]) continue;
      used[e.triangle] = used[other] = 1;
      out.push_back({e.triangle, e.corner});
    }
    return out;
  }

  void splitEdge(int t, int k) {
    const Neighbour other = neighbours_[t][k];
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const int from = surface_.triangles[t][i], to = surface_.triangles[t][j];
    const int middle = static_cast<int>(surface_.vertices.size());
    surface_.vertices.push_back(0.5 * (surface_.vertices[from] + surface_.vertices[to]));
    Vec3 place =
        0.5 * (image_.corner(surface_.triangles, t, i) + image_.corner(surface_.triangles, t, j));
    if (image_.space == ModelSpace::sphere) place = place / norm(place);
    image_.place.push_back(place);
    // The frame of the other triangle, from the corner that both have.
    Shift across;
    if (!image_.shift.empty())
      across = image_.shift[other.triangle][(other.corner + 2) % 3] - image_.shift[t][i];
    splitTriangle(t, i, j, middle, {});
    splitTriangle(other.triangle, (other.corner + 1) % 3, (other.corner + 2) % 3, middle, across);
  }

  // Corner j moves to the middle; a new triangle takes the half at j.
  void splitTriangle(int t, int i, int j, int middle, const Shift& shift) {
    const int ownI = surface_.triangles[t][i], ownJ = surface_.triangles[t][j];
    surface_.triangles.push_back(surface_.triangles[t]);
    surface_.triangles.back()[i] = middle;
    surface_.triangles[t][j] = middle;
    if (!image_.shift.empty()) {
      image_.shift.push_back(image_.shift[t]);
      image_.shift.back()[i] = shift;
      image_.shift[t][j] = shift;
    }
    splitMeshTriangle(t, ownI, ownJ, middle);
  }

  void splitMeshTriangle(int t, int from, int to, int middle) {
    Mesh& mesh = split_.mesh;
    std::vector<int>& numbers = split_.meshTriangle[shell_.number];
    const int m = numbers[t];
    const auto cornerAt = [&](int vertex) {
      int c = 0;
      while (c < 2 && split_.shellVertex[mesh.triangles[m][c]].vertex != vertex) ++c;
      return c;
    };
    const int i = cornerAt(from), j = cornerAt(to);
    const int vi = mesh.triangles[m][i], vj = mesh.triangles[m][j];
    const int v = vertices_.between(vi, vj, [&] {
      mesh.vertices.push_back(0.5 * (mesh.vertices[vi] + mesh.vertices[vj]));
      if (!mesh.colours.empty()) {
        std::array<float, 3> colour;
        for (std::size_t c = 0; c < 3; ++c)
          colour[c] = 0.5f * (mesh.colours[vi][c] + mesh.colours[vj][c]);
        mesh.colours.push_back(colour);
      }
      split_.shellVertex.push_back({shell_.number, middle});
      return static_cast<int>(mesh.vertices.size()) - 1;
    });
    numbers.push_back(static_cast<int>(mesh.triangles.size()));
    mesh.triangles.push_back(mesh.triangles[m]);
    mesh.triangles.back()[i] = mesh.triangles[m][j] = v;
    if (!mesh.uvTriangles.empty()) splitUvs(m, i, j);
  }

  void splitUvs(int m, int i, int j) {
    Mesh& mesh = split_.mesh;
    const int ui = mesh.uvTriangles[m][i], uj = mesh.uvTriangles[m][j];
    const int u = ui < 0 || uj < 0 ? -1 : uvs_.between(ui, uj, [&] {
      const Vec2 a = mesh.uvs[ui], b = mesh.uvs[uj];
      mesh.uvs.push_back({0.5 * (a.x + b.x), 0.5 * (a.y + b.y)});
      return static_cast<int>(mesh.uvs.size()) - 1;
    });
    mesh.uvTriangles.push_back(mesh.uvTriangles[m]);
    mesh.uvTriangles.back()[i] = mesh.uvTriangles[m][j] = u;
  }

  // Lowers the energy at the vertices from `first` on; the triangles around those that moved.
  std::vector<char> relaxFrom(int first) {
    ProgressiveMesh mesh(surface_.vertices.size(), surface_.triangles, image_.shift);
    PullbackEnergy energy(surface_, mesh, image_, target_, 0);
    RelaxSettings relax;
    relax.steps = 1;
    std::vector<char> fixed(surface_.vertices.size(), 0);
    std::fill(fixed.begin(), fixed.begin() + first, 1);
    CoarseToFine(mesh, image_, energy, fixed, relax).relaxAll(2);
    std::vector<char> look(surface_.triangles.size(), 0);
    for (std::size_t t = 0; t < look.size(); ++t)
      for (const int v : surface_.triangles[t])
        if (v >= first) look[t] = 1;
    return look;
  }

  const SplitShell shell_;
  ClosedSurface& surface_;
  Layout& image_;
  const TargetMetric& target_;
  SplitMesh& split_;
  const SubdivideSettings& settings_;
  const TriangleTree tree_;
  const double limit_;
  int uncrossings_ = 0;                                              // so far
  double fewestCrossing_ = std::numeric_limits<double>::infinity();  // so far
  Points positions_;
  Neighbours neighbours_;
  Midpoints vertices_, uvs_;
};

}  // namespace

Subdivided subdivide(const SplitShell& shell, const TargetMetric& target, SplitMesh& split,
                     const SubdivideSettings& settings) {
  return Subdivision(shell, target, split, settings).run();
}

}  // namespace innermap
