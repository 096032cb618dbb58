#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>

#include "innermap/core/error.h"
#include "innermap/correspond/mesh_correspondence.h"
#include "mesh/triangle_tree.h"

namespace innermap {
namespace {

constexpr double kOnSurface = 1e-3, kFarVertex = 0.02, kSamePlace = 1e-9;  // of the diagonal

std::string whereIs(const LandmarkList& list, std::size_t pair) {
  const std::size_t line = list.pairs[pair].line;
  return line > 0 ? fmt::format("line {}", line) : fmt::format("pair {}", pair + 1);
}

[[noreturn]] void failAt(const LandmarkList& list, std::size_t pair, const std::string& what) {
  throw FileError(list.name, whereIs(list, pair) + ": " + what);
}

// A surface's shells to find places on.
class Finder {
 public:
  Finder(const LandmarkList& list, const LaidOutMesh& input)
      : list_(list),
        input_(input),
        diagonal_(boundingBox(input.mesh).diagonal()),
        file_(input.mesh.vertices, input.mesh.triangles),
        inShells_(trianglesOf(input.shells())),
        shells_(input.shells().mesh.vertices, corners(input.shells(), inShells_)) {}

  double diagonal() const { return diagonal_; }

  // World position; throws when it is not on the surface.
  Vec3 positionOf(const LandmarkPlace& place, std::size_t pair) const {
    const Mesh& mesh = input_.mesh;
    if (place.vertex) {
      if (*place.vertex >= static_cast<int>(mesh.vertices.size()))
        failAt(list_, pair,
               fmt::format("there is no vertex {} in {}, which has {}, counted from 0",
                           *place.vertex, mesh.name, mesh.vertices.size()));
      if (input_.ownNumbers() && input_.shells().shellVertex[*place.vertex].shell < 0)
        failAt(list_, pair,
               fmt::format("vertex {} of {} belongs to no closed part", *place.vertex, mesh.name));
      requireOnShells(mesh.vertices[*place.vertex], pair);
      return mesh.vertices[*place.vertex];
    }
    const double distance = file_.closest(place.point).distance / diagonal_;
    if (!(distance <= kOnSurface))
      failAt(list_, pair,
             fmt::format("the point ({:.6g}, {:.6g}, {:.6g}) is {:.2g} of the diagonal away from "
                         "{}; give a place within {}",
                         place.point.x, place.point.y, place.point.z, distance, mesh.name,
                         kOnSurface));
    requireOnShells(place.point, pair);
    return place.point;
  }

  // Vertex of shells().mesh.
  int vertexAt(const LandmarkPlace& place, std::size_t pair, double& distance) const {
    distance = 0;
    const Vec3 p = positionOf(place, pair);
    if (place.vertex && input_.ownNumbers()) return *place.vertex;
    const SurfaceShells& shells = input_.shells();
    int best = -1;
    double least = 0;
    for (int v = 0; v < static_cast<int>(shells.mesh.vertices.size()); ++v) {
      if (shells.shellVertex[v].shell < 0) continue;
      const double d = squaredNorm(shells.mesh.vertices[v] - p);
      if (best >= 0 && d >= least) continue;
      best = v;
      least = d;
    }
    distance = std::sqrt(least) / diagonal_;
    return best;
  }

  SurfacePoint pointAt(const LandmarkPlace& place, std::size_t pair) const {
    const Vec3 p = positionOf(place, pair);
    if (place.vertex && input_.ownNumbers())
      for (const int t : inShells_)
        for (int k = 0; k < 3; ++k)
          if (input_.shells().mesh.triangles[t][k] == *place.vertex) {
            SurfacePoint corner{t, {0, 0, 0}};
            corner.barycentric[k] = 1;
            return corner;
          }
    SurfacePoint point = shells_.closest(p).address;
    point.triangle = inShells_[point.triangle];
    return point;
  }

 private:
  static std::vector<int> trianglesOf(const SurfaceShells& shells) {
    std::vector<int> all;
    for (const std::vector<int>& numbers : shells.meshTriangle)
      all.insert(all.end(), numbers.begin(), numbers.end());
    return all;
  }
  static std::vector<Triangle> corners(const SurfaceShells& shells, const std::vector<int>& list) {
    std::vector<Triangle> triangles;
    for (const int t : list) triangles.push_back(shells.mesh.triangles[t]);
    return triangles;
  }

  // What lies inside the solid, or in a part that was left out, has no image.
  void requireOnShells(const Vec3& p, std::size_t pair) const {
    if (input_.ownNumbers()) return;
    const double distance = shells_.closest(p).distance;
    if (distance > 3 * input_.outer->edge)
      failAt(
          list_, pair,
          fmt::format("is {:.2g} of the diagonal away from the surface that is mapped instead of "
                      "{}; choose a place on the outside",
                      distance / diagonal_, input_.mesh.name));
  }

  const LandmarkList& list_;
  const LaidOutMesh& input_;
  double diagonal_;
  TriangleTree file_;
  std::vector<int> inShells_;  // triangles of shells().mesh
  TriangleTree shells_;
};

void requireDistinct(const LandmarkList& list, const std::vector<Landmark>& landmarks,
                     const LaidOutMesh& a, const LaidOutMesh& b, double diagonalB) {
  std::map<std::array<int, 2>, std::size_t> onA;
  std::map<std::array<long long, 3>, std::size_t> onB;
  const double cell = kSamePlace * diagonalB;
  const Vec3 origin = boundingBox(b.mesh).lower;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const ShellVertex v = a.shells().shellVertex[landmarks[i].vertex];
    const auto [first, isNew] = onA.try_emplace({v.shell, v.vertex}, i);
    if (!isNew)
      failAt(list, i,
             fmt::format("its place on {} is vertex {}, like that of {}; leave one out",
                         a.mesh.name, landmarks[i].vertex, whereIs(list, first->second)));
    const Vec3 p = (positionOf(b.shells().mesh, landmarks[i].onTarget) - origin) / cell;
    const auto [same, isOther] =
        onB.try_emplace({std::llround(p.x), std::llround(p.y), std::llround(p.z)}, i);
    if (!isOther)
      failAt(list, i,
             fmt::format("its place on {} is that of {}; leave one out", b.mesh.name,
                         whereIs(list, same->second)));
  }
}

}  // namespace

PlacedLandmarks placeLandmarks(const LandmarkList& list, const LaidOutMesh& a,
                               const LaidOutMesh& b) {
  const Finder onA(list, a), onB(list, b);
  PlacedLandmarks placed;
  double farthest = 0;
  std::size_t farthestPair = 0, moved = 0;
  for (std::size_t i = 0; i < list.pairs.size(); ++i) {
    double distance = 0;
    Landmark landmark;
    landmark.vertex = onA.vertexAt(list.pairs[i].onA, i, distance);
    landmark.onTarget = onB.pointAt(list.pairs[i].onB, i);
    placed.landmarks.push_back(landmark);
    if (distance > 1e-9) ++moved;
    if (distance > farthest) {
      farthest = distance;
      farthestPair = i;
    }
  }
  requireDistinct(list, placed.landmarks, a, b, onB.diagonal());
  if (moved > 0)
    placed.note = fmt::format(
        "{}: {} taken as the nearest vertex of {}, {:.2g} of the diagonal away at most ({})",
        list.name, moved == 1 ? "1 point is" : fmt::format("{} points are", moved), a.mesh.name,
        farthest, whereIs(list, farthestPair));
  placed.far = farthest > kFarVertex;
  return placed;
}

}  // namespace innermap
