#include <algorithm>
#include <cmath>
#include <map>
#include <queue>

#include "innermap/core/run.h"
#include "innermap/lattice/cell_mesh.h"
#include "lattice/fit_boundary.h"
#include "lattice/sharp_edges.h"
#include "lattice/untangle.h"
#include "mesh/triangle_tree.h"

namespace innermap {
namespace {

// Spacings: how far a path goes from its curve, and from how far a vertex comes to the surface.
constexpr double kReach = 2;
constexpr double kDetour = 0.05;  // what a path's length costs beside its distance
constexpr int kRings = 3;         // of vertices about the paths that may move
constexpr double kStiffness = 60;

// Distances from a curve: its segments as flat triangles.
TriangleTree treeOf(const SharpCurve& curve) {
  std::vector<Triangle> segments;
  for (int i = 0; i + 1 < static_cast<int>(curve.points.size()); ++i)
    segments.push_back({i, i + 1, i + 1});
  return TriangleTree(curve.points, segments);
}

// The boundary's vertices, joined by its edges.
class Boundary {
 public:
  explicit Boundary(const StuffedMesh& mesh) : mesh_(mesh) {
    next_.resize(mesh.vertices.size() - static_cast<std::size_t>(mesh.firstBoundary));
    for (const Triangle& t : boundaryOf(mesh))
      for (int k = 0; k < 3; ++k) {
        next_[index(t[k])].push_back(t[(k + 1) % 3]);
        next_[index(t[(k + 1) % 3])].push_back(t[k]);
      }
  }

  int first() const { return mesh_.firstBoundary; }
  int end() const { return static_cast<int>(mesh_.vertices.size()); }
  const Vec3& at(int v) const { return mesh_.vertices[v]; }
  const std::vector<int>& next(int v) const { return next_[index(v)]; }

 private:
  std::size_t index(int v) const { return static_cast<std::size_t>(v - mesh_.firstBoundary); }
  const StuffedMesh& mesh_;
  std::vector<std::vector<int>> next_;
};

class PathFinder {
 public:
  PathFinder(const Boundary& boundary, double spacing) : boundary_(boundary), spacing_(spacing) {}

  std::map<int, int> taken;  // vertex -> curve, or -1 - corner

  // Empty when there is none.
  std::vector<int> cheapest(int from, int to, const TriangleTree& curve) const {
    std::map<int, std::pair<double, int>> best{{from, {0, -1}}};
    std::priority_queue<std::pair<double, int>> queue;
    queue.push({0, from});
    while (!queue.empty()) {
      const auto [negative, v] = queue.top();
      queue.pop();
      if (-negative > best[v].first) continue;
      if (v == to) break;
      for (const int w : boundary_.next(v)) {
        if (w != to && taken.count(w)) continue;
        const Vec3 middle = 0.5 * (boundary_.at(v) + boundary_.at(w));
        const double distance = curve.closest(middle, kReach * spacing_).distance / spacing_;
        if (!(distance < kReach)) continue;
        const double cost = -negative + norm(boundary_.at(v) - boundary_.at(w)) / spacing_ *
                                            (kDetour + distance * distance);
        const auto known = best.find(w);
        if (known != best.end() && known->second.first <= cost) continue;
        best[w] = {cost, v};
        queue.push({-cost, w});
      }
    }
    std::vector<int> path;
    if (!best.count(to)) return path;
    for (int v = to; v >= 0; v = best[v].second) path.push_back(v);
    std::reverse(path.begin(), path.end());
    return path;
  }

  // Not taken, or -1.
  int nearest(const Vec3& p) const {
    int found = -1;
    double least = 1.2 * spacing_;
    for (int v = boundary_.first(); v < boundary_.end(); ++v) {
      const double d = norm(boundary_.at(v) - p);
      if (d < least && !taken.count(v)) {
        least = d;
        found = v;
      }
    }
    return found;
  }

 private:
  const Boundary& boundary_;
  double spacing_;
};

class SharpFitter {
 public:
  SharpFitter(const Solid& solid, const SharpEdges& sharp, double spacing, StuffedMesh& mesh)
      : solid_(solid), sharp_(sharp), spacing_(spacing), mesh_(mesh) {
    for (const SharpCurve& curve : sharp.curves) trees_.push_back(treeOf(curve));
  }

  SharpFit run() {
    findPaths();
    SharpFit fit;
    fit.curves = sharp_.curves.size();
    for (const auto& path : paths_) fit.kept += !path.empty();
    if (target_.empty()) return fit;
    const Points before = mesh_.vertices;
    shape();
    land();
    boundVertices(before, kLeastSharpDihedral, kGreatestSharpDihedral, mesh_);
    measure(fit);
    return fit;
  }

 private:
  void findPaths() {
    const Boundary boundary(mesh_);
    PathFinder finder(boundary, spacing_);
    std::vector<int> cornerVertex(sharp_.corners.size(), -1);
    for (std::size_t c = 0; c < sharp_.corners.size(); ++c) {
      throwIfCancelled();
      const int v = cornerVertex[c] = finder.nearest(sharp_.corners[c]);
      if (v >= 0) finder.taken[v] = -1 - static_cast<int>(c);
    }
    std::vector<int> order(sharp_.curves.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return sharp_.curves[a].length > sharp_.curves[b].length;
    });
    paths_.resize(order.size());
    for (const int c : order) {
      throwIfCancelled();
      paths_[c] = pathAlong(finder, cornerVertex, c);
      for (const int v : paths_[c]) finder.taken.try_emplace(v, c);
    }
    target_ = finder.taken;
  }

  std::vector<int> pathAlong(PathFinder& finder, const std::vector<int>& cornerVertex,
                             int c) const {
    const SharpCurve& curve = sharp_.curves[c];
    if (curve.corners[0] >= 0) {
      const int from = cornerVertex[curve.corners[0]], to = cornerVertex[curve.corners[1]];
      if (from < 0 || to < 0 || from == to) return {};
      return finder.cheapest(from, to, trees_[c]);
    }
    // Closed: by way of three of its points.
    std::vector<int> stops;
    for (int k = 0; k < 3; ++k)
      stops.push_back(finder.nearest(curve.points[(curve.points.size() - 1) * k / 3]));
    if (*std::min_element(stops.begin(), stops.end()) < 0 || stops[0] == stops[1] ||
        stops[1] == stops[2] || stops[2] == stops[0])
      return {};
    std::vector<int> whole, added;
    const auto giveUp = [&] {
      for (const int v : added) finder.taken.erase(v);
      return std::vector<int>{};
    };
    for (const int s : stops) {
      finder.taken[s] = c;
      added.push_back(s);
    }
    for (int k = 0; k < 3; ++k) {
      const std::vector<int> part = finder.cheapest(stops[k], stops[(k + 1) % 3], trees_[c]);
      if (part.empty()) return giveUp();
      for (const int v : part)
        if (finder.taken.try_emplace(v, c).second) added.push_back(v);
      whole.insert(whole.end(), part.begin(), part.end() - (k < 2 ? 1 : 0));
    }
    return whole;
  }

  // Where a vertex of a path or corner goes, and the curve's direction there (0: a corner).
  Vec3 placeOf(int role, const Vec3& p, Vec3& direction) const {
    direction = {0, 0, 0};
    if (role < 0) return sharp_.corners[-1 - role];
    const ClosestPoint found = trees_[role].closest(p);
    const Points& points = sharp_.curves[role].points;
    const Vec3 along = points[found.address.triangle + 1] - points[found.address.triangle];
    if (norm(along) > 0) direction = along / norm(along);
    return found.position;
  }

  // All within some rings of the paths moves to better shapes; springs hold what is on the surface.
  void shape() {
    std::vector<int> local(mesh_.vertices.size(), -1);
    std::vector<bool> near(mesh_.vertices.size(), false);
    for (const auto& [v, role] : target_) near[v] = true;
    for (int ring = 0; ring < kRings; ++ring) {
      std::vector<bool> wider = near;
      for (const Tetrahedron& t : mesh_.tetrahedra)
        if (near[t[0]] || near[t[1]] || near[t[2]] || near[t[3]])
          for (const int v : t) wider[v] = true;
      near = std::move(wider);
    }
    TetPatch patch;
    for (const Tetrahedron& t : mesh_.tetrahedra) {
      if (!near[t[0]] && !near[t[1]] && !near[t[2]] && !near[t[3]]) continue;
      std::array<int, 4> cell{};
      for (int k = 0; k < 4; ++k) {
        int& l = local[t[k]];
        if (l < 0) {
          l = static_cast<int>(patch.vertices.size());
          patch.vertices.push_back(mesh_.vertices[t[k]] / spacing_);
          patch.free.push_back(near[t[k]]);
          global_.push_back(t[k]);
        }
        cell[k] = l;
      }
      patch.tets.push_back(cell);
      patch.rest.push_back(restOf(signedVolume(mesh_.vertices, t)));
    }
    setSprings(patch);
    UntangleSettings settings;
    settings.volumeShare = 0.05;
    settings.rounds = 3;
    settings.stepsARound = 30;
    settings.afterRound = [this](TetPatch& p, int) { setSprings(p); };
    untangle(patch, settings);
    for (std::size_t l = 0; l < global_.size(); ++l)
      if (patch.free[l]) mesh_.vertices[global_[l]] = spacing_ * patch.vertices[l];
  }

  // A regular tetrahedron of that volume; of a lattice's half at least, so that flat ones grow.
  Mat3 restOf(double volume) const {
    const double unit = std::max(volume / std::pow(spacing_, 3), 1.0 / 24);
    const double a = std::cbrt(3 * unit);  // of a cube, of which it is a third
    const Mat3 rest = inverseEdges({Vec3{0, 0, 0}, Vec3{a, a, 0}, Vec3{0, a, a}, Vec3{a, 0, a}});
    return rest;
  }

  void setSprings(TetPatch& patch) const {
    patch.springs.clear();
    for (std::size_t l = 0; l < global_.size(); ++l) {
      const int v = global_[l];
      if (!patch.free[l] || v < mesh_.firstBoundary) continue;
      const Vec3 p = spacing_ * patch.vertices[l];
      const auto role = target_.find(v);
      const auto add = [&](const Vec3& place, const Vec3& normal) {
        patch.springs.push_back({static_cast<int>(l), place / spacing_, normal, kStiffness});
      };
      if (role == target_.end()) {
        const Solid::Closest found = solid_.closest(p, kReach * spacing_);
        if (found.onSurface.triangle < 0) {
          add(p, {0, 0, 0});
          continue;
        }
        const Vec3 area = areaVector(solid_.surface(), found.onSurface.triangle);
        if (norm(area) > 0) add(found.position, area / norm(area));
        continue;
      }
      Vec3 direction;
      const Vec3 place = placeOf(role->second, p, direction);
      if (!(norm(direction) > 0)) {
        add(place, {0, 0, 0});
        continue;
      }
      const Vec3 other = std::abs(direction.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
      const Vec3 n = cross(direction, other) / norm(cross(direction, other));
      add(place, n);
      add(place, cross(direction, n));
    }
  }

  void land() {
    for (const int v : global_) {
      if (v < mesh_.firstBoundary) continue;
      Vec3& p = mesh_.vertices[v];
      const auto role = target_.find(v);
      Vec3 direction;
      if (role != target_.end()) {
        p = placeOf(role->second, p, direction);
        continue;
      }
      const Solid::Closest found = solid_.closest(p, kReach * spacing_);
      if (found.onSurface.triangle >= 0) p = found.position;
    }
  }

  // From points of each curve to its path; of curves without, to all paths.
  void measure(SharpFit& fit) const {
    std::vector<Triangle> segments;
    for (const auto& path : paths_)
      for (std::size_t i = 0; i + 1 < path.size(); ++i)
        segments.push_back({path[i], path[i + 1], path[i + 1]});
    if (segments.empty()) return;
    const TriangleTree tree(mesh_.vertices, segments);
    double sum = 0, count = 0;
    for (const SharpCurve& curve : sharp_.curves)
      for (std::size_t i = 0; i + 1 < curve.points.size(); ++i) {
        const Vec3 middle = 0.5 * (curve.points[i] + curve.points[i + 1]);
        const double weight = norm(curve.points[i + 1] - curve.points[i]);
        const double d = tree.closest(middle).distance;
        sum += weight * d * d;
        count += weight;
        fit.max = std::max(fit.max, d);
      }
    fit.rms = count > 0 ? std::sqrt(sum / count) : 0;
  }

  const Solid& solid_;
  const SharpEdges& sharp_;
  double spacing_;
  StuffedMesh& mesh_;
  std::vector<TriangleTree> trees_;      // of each curve
  std::vector<std::vector<int>> paths_;  // of each curve; empty: none
  std::map<int, int> target_;            // of each vertex on a path: as PathFinder::taken
  std::vector<int> global_;              // of the patch's vertices
};

}  // namespace

SharpFit fitSharpEdges(const Solid& solid, const SharpEdges& sharp, double spacing,
                       StuffedMesh& mesh) {
  reportProgress("drawing the sharp edges", 0);
  return SharpFitter(solid, sharp, spacing, mesh).run();
}

}  // namespace innermap
