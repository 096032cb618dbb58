// A tetrahedron cut along the voxels that it lies in, and what it holds shared out among them.
//
// The exact conservative remap of Powell and Abel, "An exact general remeshing scheme applied to
// physically conservative voxelization" (J. Comput. Phys. 297, 2015). In place of their clipped
// polyhedra tetrahedra are cut off where edges cross a plane between voxels: then the volumes of
// parts are products of shares of edges, which sum to 1 however thin or flat the tetrahedron is.
// What is left of it is not cut up: the whole counts on one side, and what is cut off is taken away
// from it there.
#pragma once

#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "innermap/core/vec3.h"

namespace innermap {

struct TetrahedronCorner {
  std::array<double, 3> at;  // voxel (i, j, k) spans [i, i + 1] x [j, j + 1] x [k, k + 1]
  double density;
};
using Tetrahedron = std::array<const TetrahedronCorner*, 4>;

struct VolumeAndMass {
  double volume = 0, mass = 0;
};

// Of a tetrahedron of volume 1 whose corners are in order of their last coordinates, the part below
// a plane there between the first and the last; density is linear between corners.
VolumeAndMass partBelow(const Tetrahedron& sorted, double plane);

namespace detail {

// Voxels that a part counts in along an axis: one layer of them, or two, one of which it is taken
// away from.
struct Layers {
  int lower = 0;
  double inLower = 1, inUpper = 0;
};

inline TetrahedronCorner between(const TetrahedronCorner& a, const TetrahedronCorner& b, double t) {
  TetrahedronCorner out;
  for (std::size_t k = 0; k < 3; ++k) out.at[k] = a.at[k] + t * (b.at[k] - a.at[k]);
  out.density = a.density + t * (b.density - a.density);
  return out;
}

inline void sortAlong(std::size_t axis, Tetrahedron& tet) {
  const auto order = [&](std::size_t a, std::size_t b) {
    const TetrahedronCorner *p = tet[a], *q = tet[b];
    const bool swap = q->at[axis] < p->at[axis];
    tet[a] = swap ? q : p;
    tet[b] = swap ? p : q;
  };
  order(0, 1), order(2, 3), order(0, 2), order(1, 3), order(1, 2);
}

// Hands a part on to all voxels that it counts in, of x and y; z is that of one layer.
template <class Visit>
void visitLayers(const Layers& x, const Layers& y, int z, const VolumeAndMass& part,
                 const Visit& visit) {
  for (int i = 0; i < (x.inUpper == 0 ? 1 : 2); ++i)
    for (int j = 0; j < (y.inUpper == 0 ? 1 : 2); ++j) {
      const double sign = (i ? x.inUpper : x.inLower) * (j ? y.inUpper : y.inLower);
      visit(openvdb::Coord(x.lower + i, y.lower + j, z), sign * part.volume, sign * part.mass);
    }
}

// The last axis needs no parts but their volumes.
template <class Visit>
void splitLast(Tetrahedron tet, double volume, const Layers& x, const Layers& y,
               const Visit& visit) {
  sortAlong(2, tet);
  const double from = tet[0]->at[2], to = tet[3]->at[2];
  VolumeAndMass done;
  double plane = std::floor(from) + 1;
  for (; plane < to; ++plane) {
    const VolumeAndMass below = partBelow(tet, plane);
    visitLayers(x, y, static_cast<int>(plane) - 1,
                {volume * (below.volume - done.volume), volume * (below.mass - done.mass)}, visit);
    done = below;
  }
  const double mass =
      0.25 * (tet[0]->density + tet[1]->density + tet[2]->density + tet[3]->density);
  visitLayers(x, y, static_cast<int>(plane) - 1,
              {volume * (1 - done.volume), volume * (mass - done.mass)}, visit);
}

// Calls next(part, volume, layers) for parts that make up the tetrahedron.
template <std::size_t kAxis, class Next>
void splitAlong(Tetrahedron tet, double volume, const Next& next) {
  sortAlong(kAxis, tet);
  const auto [a, b, c, d] = tet;
  const auto share = [](const TetrahedronCorner* p, const TetrahedronCorner* q, double plane) {
    return (plane - p->at[kAxis]) / (q->at[kAxis] - p->at[kAxis]);
  };
  double plane = std::floor(a->at[kAxis]) + 1;
  int whole = static_cast<int>(plane) - 1;  // the layer where the whole counts
  for (; plane < d->at[kAxis]; ++plane) {
    const int lower = static_cast<int>(plane) - 1;
    if (plane >= c->at[kAxis]) {  // only d is above
      const double s = share(d, a, plane), t = share(d, b, plane), u = share(d, c, plane);
      const TetrahedronCorner p = between(*d, *a, s), q = between(*d, *b, t),
                              r = between(*d, *c, u);
      next({d, &p, &q, &r}, s * t * u * volume, Layers{lower, -1, 1});
      continue;
    }
    whole = lower + 1;
    const Layers below{lower, 1, -1};
    const double s = share(a, c, plane), t = share(a, d, plane);
    const TetrahedronCorner p = between(*a, *c, s), q = between(*a, *d, t);
    if (plane <= b->at[kAxis]) {  // only a is below
      const double u = share(a, b, plane);
      const TetrahedronCorner r = between(*a, *b, u);
      next({a, &p, &q, &r}, s * t * u * volume, below);
      continue;
    }
    const double u = share(b, c, plane), v = share(b, d, plane);
    const TetrahedronCorner r = between(*b, *c, u), w = between(*b, *d, v);
    next({a, b, &p, &q}, s * t * volume, below);
    next({b, &p, &q, &w}, s * (1 - t) * v * volume, below);
    next({b, &p, &r, &w}, (1 - s) * u * v * volume, below);
  }
  next(tet, volume, Layers{whole});
}

}  // namespace detail

// Calls visit(voxel, volume, mass) for parts that make up the tetrahedron, each in one voxel, with
// its share of `volume` (which need not be that of the corners: say, of what they are the image of)
// and the integral over that of the density, which is linear between the corners. A voxel may be
// visited several times, and parts be taken away from it again: what is left of 1e-15 of the volume
// is rounding. Voxels lie in the box of the corners. All corners finite, below 1e9.
template <class Visit>
void splitAtVoxels(const Tetrahedron& tet, double volume, const Visit& visit) {
  detail::splitAlong<0>(
      tet, volume, [&](const Tetrahedron& slab, double inSlab, const detail::Layers& x) {
        detail::splitAlong<1>(
            slab, inSlab, [&](const Tetrahedron& column, double inColumn, const detail::Layers& y) {
              detail::splitLast(column, inColumn, x, y, visit);
            });
      });
}

inline VolumeAndMass partBelow(const Tetrahedron& sorted, double plane) {
  const double a = sorted[0]->at[2], b = sorted[1]->at[2], c = sorted[2]->at[2],
               d = sorted[3]->at[2];
  const double ra = sorted[0]->density, rb = sorted[1]->density, rc = sorted[2]->density,
               rd = sorted[3]->density;
  // The part about one corner, with the shares of its edges: the volume is their product.
  const auto corner = [](double r, double s, double t, double u, double rs, double rt, double ru) {
    const double volume = s * t * u;
    return VolumeAndMass{volume,
                         volume * (r + 0.25 * (s * (rs - r) + t * (rt - r) + u * (ru - r)))};
  };
  if (plane <= b) {
    const double way = plane - a;
    return corner(ra, way / (b - a), way / (c - a), way / (d - a), rb, rc, rd);
  }
  if (plane >= c) {
    const double way = d - plane;
    const VolumeAndMass above = corner(rd, way / (d - a), way / (d - b), way / (d - c), ra, rb, rc);
    return {1 - above.volume, 0.25 * (ra + rb + rc + rd) - above.mass};
  }
  // Bisected on the edge from a to c, at p: one part has d alone above, the other b alone below.
  const double t = (plane - a) / (c - a), rp = ra + t * (rc - ra);
  const VolumeAndMass above =
      corner(rd, (d - plane) / (d - a), (d - plane) / (d - b), 1, ra, rb, rp);
  const VolumeAndMass below =
      corner(rb, (plane - b) / (c - b), (plane - b) / (d - b), 1, rc, rd, rp);
  return {t * (1 - above.volume) + (1 - t) * below.volume,
          t * (0.25 * (ra + rb + rp + rd) - above.mass) + (1 - t) * below.mass};
}

}  // namespace innermap
