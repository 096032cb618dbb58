#include "lattice/detail/thin_parts.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr char kThinPartsStage[] = "looking for thin parts";
constexpr double kLatticeReach = 0.56;  // spacings; sqrt(5) / 4 is the lattice's covering radius

class Finder {
 public:
  Finder(const Solid& solid, const LatticeSigns& signs) : solid_(solid), signs_(signs) {}

  // sign -1 looks into the solid for walls, +1 out of it for gaps: the node in the middle of one
  // that is on the wrong side, or -1.
  std::int64_t middleOf(const Vec3& x, const Vec3& normal, double sign) const {
    const Vec3 into = sign * normal;
    const double h = signs_.lattice.spacing();
    const auto wrong = [&](std::size_t node) {
      return (signs_.side[node] == NodeSide::inside) != (sign < 0);
    };
    if (!wrong(signs_.lattice.nearest(x + kLatticeReach * h * into))) return -1;
    // How far a ball that touches the surface in x can be blown up, by halving.
    constexpr int kHalvings = 10;
    double depth = 0, beyond = kLatticeReach * h;
    Solid::Closest other{};
    other.onSurface.triangle = -1;
    for (int k = 0; k < kHalvings; ++k) {
      const double s = k == 0 ? beyond : 0.5 * (depth + beyond);
      const Solid::Closest found = solid_.closest(x + s * into, 2 * h);
      if (found.onSurface.triangle >= 0 && found.distance < 0.97 * s) {
        beyond = s;
        other = found;
      } else {
        depth = s;
        if (k == 0) break;
      }
    }
    if (other.onSurface.triangle < 0) return -1;
    // Both walls face away from one another; at a sharp edge they do not.
    const Vec3 area = areaVector(solid_.surface(), other.onSurface.triangle);
    if (dot(area, normal) > -0.5 * norm(area)) return -1;
    const std::size_t node = signs_.lattice.nearest(x + depth * into);
    return wrong(node) ? static_cast<std::int64_t>(node) : -1;
  }

  bool lost(const Vec3& x) const {
    const double h = signs_.lattice.spacing();
    const std::size_t nearest = signs_.lattice.nearest(x);
    if (signs_.side[nearest] == NodeSide::inside) return false;
    for (const std::ptrdiff_t offset : signs_.lattice.offsets(signs_.lattice.second(nearest)))
      if (signs_.side[nearest + static_cast<std::size_t>(offset)] == NodeSide::inside &&
          norm(signs_.lattice.position(nearest + static_cast<std::size_t>(offset)) - x) < 1.25 * h)
        return false;
    return true;
  }

 private:
  const Solid& solid_;
  const LatticeSigns& signs_;
};

}  // namespace

ThinParts thinParts(const Solid& solid, const LatticeSigns& signs) {
  const Mesh& surface = solid.surface();
  const Finder finder(solid, signs);
  const double step = 0.5 * signs.lattice.spacing();
  ThinParts parts;
  std::mutex mutex;
  parallelBlocks(
      surface.triangles.size(), 64,
      [&](std::size_t begin, std::size_t end) {
        ThinParts own;
        for (std::size_t t = begin; t < end; ++t) {
          const Triangle& tri = surface.triangles[t];
          const Vec3 a = surface.vertices[tri[0]], u = surface.vertices[tri[1]] - a,
                     v = surface.vertices[tri[2]] - a;
          const Vec3 area = cross(u, v);
          if (!(norm(area) > 0)) continue;
          const Vec3 normal = area / norm(area);
          const double longest = std::max({norm(u), norm(v), norm(u - v)});
          const int n = std::max(1, static_cast<int>(std::ceil(longest / step)));
          for (int i = 0; i < n; ++i) {
            throwIfCancelled();
            for (int j = 0; j < n - i; ++j) {
              const Vec3 x = a + ((i + 1.0 / 3) / n) * u + ((j + 1.0 / 3) / n) * v;
              ++own.points;
              own.lost += finder.lost(x);
              const std::int64_t wall = finder.middleOf(x, normal, -1);
              const std::int64_t gap = finder.middleOf(x, normal, 1);
              if (wall >= 0) own.walls.push_back(static_cast<std::size_t>(wall));
              if (gap >= 0) own.gaps.push_back(static_cast<std::size_t>(gap));
            }
          }
        }
        const std::lock_guard<std::mutex> lock(mutex);
        parts.points += own.points;
        parts.lost += own.lost;
        parts.walls.insert(parts.walls.end(), own.walls.begin(), own.walls.end());
        parts.gaps.insert(parts.gaps.end(), own.gaps.begin(), own.gaps.end());
      },
      kThinPartsStage);
  for (auto* nodes : {&parts.walls, &parts.gaps}) {
    std::sort(nodes->begin(), nodes->end());
    nodes->erase(std::unique(nodes->begin(), nodes->end()), nodes->end());
  }
  return parts;
}

}  // namespace innermap
