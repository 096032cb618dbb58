#include "surface/detail/refining/map_samples.h"

#include <algorithm>

#include "core/random.h"

namespace innermap {

Points unitNormals(const ClosedSurface& surface) {
  Points out;
  out.reserve(surface.triangles.size());
  for (const Triangle& t : surface.triangles) {
    const Vec3& a = surface.vertices[t[0]];
    const Vec3 n = cross(surface.vertices[t[1]] - a, surface.vertices[t[2]] - a);
    out.push_back(n / std::max(norm(n), 1e-300));
  }
  return out;
}

std::vector<MapSample> sampleSource(const ClosedSurface& surface, const Layout& layout,
                                    std::size_t count, std::uint64_t seed) {
  const double scale = unitAreaScale(surface.vertices, surface.triangles);
  const CounterRandom random(seed, 0x5a3b1e);
  std::vector<MapSample> out;
  out.reserve(count);
  double covered = 0;  // area so far, of 1
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const Triangle& tri = surface.triangles[t];
    const Vec3& a = surface.vertices[tri[0]];
    const Vec3 e1 = scale * (surface.vertices[tri[1]] - a),
               e2 = scale * (surface.vertices[tri[2]] - a);
    const Vec3 n = cross(e1, e2);
    const double twice = norm(n);
    covered += 0.5 * twice;
    while (out.size() < count &&
           (static_cast<double>(out.size()) + random.uniform(3 * out.size())) /
                   static_cast<double>(count) <
               covered) {
      double u = random.uniform(3 * out.size() + 1), v = random.uniform(3 * out.size() + 2);
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const int i = static_cast<int>(t);
      const Vec3 p = layout.corner(surface.triangles, i, 0),
                 pe = layout.corner(surface.triangles, i, 1) - p,
                 pf = layout.corner(surface.triangles, i, 2) - p;
      // Orthonormal frame x along e1: e1 = (l, 0), e2 = (c, h).
      const double l = norm(e1);
      if (!(l > 0) || !(twice > 1e-12 * l * l)) {
        out.push_back({p, {}, {}, {}});
        continue;
      }
      const double c = dot(e1, e2) / l, h = twice / l;
      out.push_back({p + (u * pe + v * pf), pe / l, (pf - (c / l) * pe) / h, n / twice});
    }
  }
  out.erase(std::remove_if(out.begin(), out.end(),
                           [](const MapSample& s) { return !(squaredNorm(s.e) > 0); }),
            out.end());
  return out;
}

}  // namespace innermap
