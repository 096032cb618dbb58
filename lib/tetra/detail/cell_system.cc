#include "tetra/detail/cell_system.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/disjoint_sets.h"
#include "innermap/core/run.h"
#include "lattice/cell_signs.h"
#include "lattice/untangle.h"

namespace innermap {
namespace {

constexpr std::size_t kBlock = 4096;

std::array<Vec3, 4> cornersOf(const Points& at, const Tetrahedron& t) {
  return {at[t[0]], at[t[1]], at[t[2]], at[t[3]]};
}

// Of edges of length 1.
const Mat3& regularRest() {
  static const Mat3 rest = inverseEdges({{{0, 0, 0},
                                          {1, 0, 0},
                                          {0.5, std::sqrt(0.75), 0},
                                          {0.5, std::sqrt(1.0 / 12), std::sqrt(2.0 / 3)}}});
  return rest;
}

const Mat3& squareRest() {
  static const Mat3 rest{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  return rest;
}

// The tetrahedra's patches, from the marks of the vertices that move.
class Patches {
 public:
  Patches(const CellSystem& system, const std::vector<int>& moving)
      : system_(system), moving_(moving), numbers_(system.vertices(), -1) {
    for (std::size_t m = 0; m < moving.size(); ++m) numbers_[moving[m]] = static_cast<int>(m);
  }

  std::vector<CellPatch> make() {
    DisjointSets sets(moving_.size());
    std::vector<int> tets;
    for (const int v : moving_)
      for (std::size_t i = system_.first[v]; i < system_.first[v + 1]; ++i) {
        const Tetrahedron& t = system_.tets[system_.around[i]];
        bool lowest = true;
        for (const int w : t)
          if (numbers_[w] >= 0) {
            sets.unite(numbers_[v], numbers_[w]);
            lowest = lowest && v <= w;
          }
        if (lowest) tets.push_back(system_.around[i]);
      }
    std::sort(tets.begin(), tets.end());
    return part(sets.representatives(), tets);
  }

 private:
  std::vector<CellPatch> part(const std::vector<int>& sets, const std::vector<int>& tets) {
    std::vector<int> patchOf(moving_.size(), -1);
    std::vector<CellPatch> patches;
    for (std::size_t m = 0; m < moving_.size(); ++m) {
      int& patch = patchOf[sets[m]];  // a set's lowest member comes first
      if (patch < 0) {
        patch = static_cast<int>(patches.size());
        patches.emplace_back();
      }
      patches[patch].vertices.push_back(moving_[m]);
    }
    for (CellPatch& patch : patches) patch.moving = patch.vertices.size();
    for (const int t : tets)
      for (const int v : system_.tets[t])
        if (numbers_[v] >= 0) {
          patches[patchOf[sets[numbers_[v]]]].tets.push_back(t);
          break;
        }
    for (CellPatch& patch : patches) addHolding(patch);
    return patches;
  }

  void addHolding(CellPatch& patch) const {
    std::vector<int> holding;
    for (const int t : patch.tets)
      for (const int v : system_.tets[t])
        if (numbers_[v] < 0) holding.push_back(v);
    std::sort(holding.begin(), holding.end());
    holding.erase(std::unique(holding.begin(), holding.end()), holding.end());
    patch.vertices.insert(patch.vertices.end(), holding.begin(), holding.end());
  }

  const CellSystem& system_;
  const std::vector<int>& moving_;
  std::vector<int> numbers_;  // among those that move, or -1
};

}  // namespace

CellSystem::CellSystem(const CellMesh& mesh, RestShape restShape)
    : places(mesh.vertices),
      tets(mesh.tetrahedra),
      ownTets(mesh.tetrahedra.size()),
      shape(restShape),
      boundary(boundaryTriangles(mesh)) {
  for (const Hexahedron& h : mesh.hexahedra)
    for (const Tetrahedron& t : cornerTetrahedra(h)) tets.push_back(t);
  first.assign(mesh.vertices.size() + 1, 0);
  for (const Tetrahedron& t : tets)
    for (const int v : t) ++first[v + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  around.resize(first.back());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (std::size_t t = 0; t < tets.size(); ++t)
    for (const int v : tets[t]) around[next[v]++] = static_cast<int>(t);
  onBoundary.assign(mesh.vertices.size(), 0);
  for (const Triangle& t : boundary)
    for (const int v : t) onBoundary[v] = 1;
}

Mat3 CellSystem::rest(int tet) const {
  const bool ofTetrahedron = static_cast<std::size_t>(tet) < ownTets;
  const Mat3& regular = ofTetrahedron ? regularRest() : squareRest();
  if (shape == RestShape::regular) return regular;
  const std::array<Vec3, 4> corners = cornersOf(places, tets[tet]);
  const double volume = 6 * signedVolume(places, tets[tet]);
  if (volume > 0) {
    const Mat3 own = inverseEdges(corners);
    if (std::isfinite(determinant(own))) return own;
  }
  const double edge = std::cbrt(std::abs(volume)) + norm(corners[1] - corners[0]);
  Mat3 scaled = regular;
  for (auto& row : scaled)
    for (double& x : row) x /= edge > 0 ? edge : 1;
  return scaled;
}

double CellSystem::quality(const Points& at, int tet) const {
  const Mat3 j = jacobianOf(cornersOf(at, tets[tet]), rest(tet));
  double squares = 0;
  for (const auto& row : j)
    for (const double x : row) squares += x * x;
  const double size = squares / 3;
  return size > 0 ? determinant(j) / (size * std::sqrt(size)) : 0;
}

std::vector<int> poorTets(const CellSystem& system, const Points& at, double least) {
  const std::size_t count = system.tets.size();
  std::vector<std::vector<int>> parts((count + kBlock - 1) / kBlock);
  parallelBlocks(count, kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      if (!(system.quality(at, static_cast<int>(t)) >= least))
        parts[begin / kBlock].push_back(static_cast<int>(t));
  });
  std::vector<int> poor;
  for (const auto& part : parts) poor.insert(poor.end(), part.begin(), part.end());
  return poor;
}

std::size_t invertedCells(const CellMesh& mesh, const Points& at) {
  std::size_t inverted = 0;
  for (const Tetrahedron& t : mesh.tetrahedra) inverted += isInverted(at, t);
  for (const Hexahedron& h : mesh.hexahedra) inverted += isInverted(at, h);
  return inverted;
}

std::vector<CellPatch> growPatches(const CellSystem& system, const std::vector<int>& seeds,
                                   int rings, bool boundaryMoves) {
  std::vector<char> reached(system.vertices(), 0);
  std::vector<int> all, edge;
  const auto reach = [&](int tet, std::vector<int>& to) {
    for (const int v : system.tets[tet])
      if (!reached[v]) {
        reached[v] = 1;
        to.push_back(v);
      }
  };
  for (const int t : seeds) reach(t, edge);
  for (int ring = 0; ring <= rings && !edge.empty(); ++ring) {
    all.insert(all.end(), edge.begin(), edge.end());
    std::vector<int> next;
    if (ring < rings)
      for (const int v : edge)
        for (std::size_t i = system.first[v]; i < system.first[v + 1]; ++i)
          reach(system.around[i], next);
    edge = std::move(next);
  }
  if (!boundaryMoves)
    all.erase(std::remove_if(all.begin(), all.end(), [&](int v) { return system.onBoundary[v]; }),
              all.end());
  std::sort(all.begin(), all.end());
  return Patches(system, all).make();
}

CellPatch wholePatch(const CellSystem& system, bool boundaryMoves) {
  CellPatch patch;
  std::vector<int> holding;
  for (std::size_t v = 0; v < system.vertices(); ++v)
    if (system.first[v] < system.first[v + 1])
      (boundaryMoves || !system.onBoundary[v] ? patch.vertices : holding)
          .push_back(static_cast<int>(v));
  patch.moving = patch.vertices.size();
  patch.vertices.insert(patch.vertices.end(), holding.begin(), holding.end());
  patch.tets.resize(system.tets.size());
  std::iota(patch.tets.begin(), patch.tets.end(), 0);
  return patch;
}

}  // namespace innermap
