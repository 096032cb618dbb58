#include "lattice/fit_boundary.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>

#include "core/pi.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr char kFitting[] = "fitting the boundary";
constexpr int kHalvings = 5;  // then the vertex stays where it was

// Whether a cell is right-handed with all dihedral angles within bounds.
class Shape {
 public:
  Shape(double least, double greatest)
      : least_(std::cos(least * kPi / 180)), greatest_(std::cos(greatest * kPi / 180)) {}

  bool good(const Points& v, const Tetrahedron& t) const {
    const Vec3 a = v[t[1]] - v[t[0]], b = v[t[2]] - v[t[0]], c = v[t[3]] - v[t[0]];
    std::array<Vec3, 4> n{cross(b - a, c - a), cross(c, b), cross(a, c), cross(b, a)};
    if (!(dot(a, cross(b, c)) > 0)) return false;
    for (Vec3& m : n) m = m / norm(m);
    for (int f = 0; f < 4; ++f)
      for (int g = 0; g < f; ++g) {
        const double cosine = -dot(n[f], n[g]);
        if (!(cosine <= least_ && cosine >= greatest_)) return false;
      }
    return true;
  }

 private:
  double least_, greatest_;  // cosines
};

}  // namespace

void boundVertices(const Points& before, double leastDihedral, double greatestDihedral,
                   StuffedMesh& mesh) {
  const Shape shape(leastDihedral, greatestDihedral);
  const Points wanted = mesh.vertices;
  std::vector<std::uint8_t> moves(before.size());
  for (std::size_t v = 0; v < before.size(); ++v) moves[v] = squaredNorm(wanted[v] - before[v]) > 0;
  std::vector<int> touching;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const Tetrahedron& c = mesh.tetrahedra[t];
    if (moves[c[0]] || moves[c[1]] || moves[c[2]] || moves[c[3]])
      touching.push_back(static_cast<int>(t));
  }
  std::vector<int> suspects = touching;
  std::vector<std::uint8_t> halvings(before.size(), 0);
  std::vector<std::atomic<bool>> back(before.size());
  for (bool changed = true; changed;) {
    for (auto& b : back) b.store(false, std::memory_order_relaxed);
    parallelBlocks(suspects.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const Tetrahedron& c = mesh.tetrahedra[suspects[k]];
        if (shape.good(mesh.vertices, c)) continue;
        for (const int v : c)
          if (moves[v]) back[v].store(true, std::memory_order_relaxed);
      }
    });
    changed = false;
    for (std::size_t v = 0; v < before.size(); ++v) {
      if (!back[v].load(std::memory_order_relaxed) || halvings[v] > kHalvings) continue;
      changed = true;
      const double share = ++halvings[v] > kHalvings ? 0 : std::ldexp(1.0, -halvings[v]);
      mesh.vertices[v] = before[v] + share * (wanted[v] - before[v]);
    }
    if (!changed) break;
    // Only cells with a vertex that went back can have changed for the better or the worse.
    suspects.clear();
    std::copy_if(touching.begin(), touching.end(), std::back_inserter(suspects), [&](int t) {
      const Tetrahedron& c = mesh.tetrahedra[t];
      return std::any_of(c.begin(), c.end(),
                         [&](int v) { return back[v].load(std::memory_order_relaxed); });
    });
  }
}

void holdWarped(StuffedMesh& mesh) {
  Points before = mesh.vertices;
  std::copy(mesh.unwarped.begin(), mesh.unwarped.end(), before.begin() + mesh.firstBoundary);
  boundVertices(before, kLeastDihedral, kGreatestDihedral, mesh);
  mesh.unwarped = {};
}

void fitBoundary(const Solid& solid, double spacing, StuffedMesh& mesh) {
  const auto first = static_cast<std::size_t>(mesh.firstBoundary);
  const Points before = mesh.vertices;
  parallelBlocks(
      before.size() - first, 256,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = first + begin; i < first + end; ++i) {
          const Solid::Closest found = solid.closest(before[i], spacing);
          if (found.onSurface.triangle >= 0) mesh.vertices[i] = found.position;
        }
      },
      kFitting);
  boundVertices(before, kLeastDihedral, kGreatestDihedral, mesh);
}

}  // namespace innermap
