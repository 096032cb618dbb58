#include "innermap/tetra/detail/fit_boundary.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "innermap/core/detail/pi.h"
#include "innermap/core/parallel.h"

namespace innermap {
namespace {

constexpr char kStage[] = "fitting the boundary";
constexpr int kHalvings = 5;  // then the vertex stays where it was

// Whether the cell is right-handed with all dihedral angles within bounds.
bool wellShaped(const Points& v, const Tetrahedron& t) {
  static const double kLeast = std::cos(kLeastDihedral * kPi / 180);
  static const double kGreatest = std::cos(kGreatestDihedral * kPi / 180);
  const Vec3 a = v[t[1]] - v[t[0]], b = v[t[2]] - v[t[0]], c = v[t[3]] - v[t[0]];
  std::array<Vec3, 4> n{cross(b - a, c - a), cross(c, b), cross(a, c), cross(b, a)};
  if (!(dot(a, cross(b, c)) > 0)) return false;
  for (Vec3& m : n) m = m / norm(m);
  for (int f = 0; f < 4; ++f)
    for (int g = 0; g < f; ++g) {
      const double cosine = -dot(n[f], n[g]);
      if (!(cosine <= kLeast && cosine >= kGreatest)) return false;
    }
  return true;
}

}  // namespace

void fitBoundary(const Solid& solid, double spacing, StuffedMesh& mesh, Progress* progress) {
  const auto first = static_cast<std::size_t>(mesh.firstBoundary);
  const std::size_t count = mesh.vertices.size() - first;
  Points from(mesh.vertices.begin() + mesh.firstBoundary, mesh.vertices.end()), to = from;
  parallelBlocks(
      count, 256,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const Solid::Closest found = solid.closest(from[i], spacing);
          if (found.onSurface.triangle >= 0) to[i] = found.position;
        }
      },
      progress, kStage);
  std::vector<int> touching;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const Tetrahedron& c = mesh.tetrahedra[t];
    if (std::max({c[0], c[1], c[2], c[3]}) >= mesh.firstBoundary)
      touching.push_back(static_cast<int>(t));
  }
  std::vector<int> suspects = touching;
  std::vector<std::uint8_t> halvings(count, 0);
  std::vector<std::atomic<bool>> back(count);
  for (std::size_t i = 0; i < count; ++i) mesh.vertices[first + i] = to[i];
  for (bool changed = true; changed;) {
    for (auto& b : back) b.store(false, std::memory_order_relaxed);
    parallelBlocks(
        suspects.size(), 4096,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t k = begin; k < end; ++k) {
            const Tetrahedron& c = mesh.tetrahedra[suspects[k]];
            if (wellShaped(mesh.vertices, c)) continue;
            for (const int v : c)
              if (v >= mesh.firstBoundary)
                back[static_cast<std::size_t>(v) - first].store(true, std::memory_order_relaxed);
          }
        },
        progress);
    changed = false;
    for (std::size_t i = 0; i < count; ++i) {
      if (!back[i].load(std::memory_order_relaxed) || halvings[i] > kHalvings) continue;
      changed = true;
      const double share = ++halvings[i] > kHalvings ? 0 : std::ldexp(1.0, -halvings[i]);
      mesh.vertices[first + i] = from[i] + share * (to[i] - from[i]);
    }
    if (!changed) break;
    // Only cells with a vertex that went back can have changed for the better or the worse.
    const auto moved = [&](int t) {
      for (const int v : mesh.tetrahedra[t])
        if (v >= mesh.firstBoundary &&
            back[static_cast<std::size_t>(v) - first].load(std::memory_order_relaxed))
          return true;
      return false;
    };
    suspects.clear();
    std::copy_if(touching.begin(), touching.end(), std::back_inserter(suspects), moved);
  }
}

}  // namespace innermap
