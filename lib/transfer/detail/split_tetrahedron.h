// A tetrahedron cut along the voxels that it lies in, and what it holds shared out among them.
//
// The exact conservative remap of Powell and Abel, "An exact general remeshing scheme applied to
// physically conservative voxelization" (J. Comput. Phys. 297, 2015). In place of their clipped
// polyhedra edges are bisected where they cross a plane between voxels: then the volumes of parts
// are products of shares of edges, which sum to 1 however thin or flat the tetrahedron is.
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

inline TetrahedronCorner between(const TetrahedronCorner& a, const TetrahedronCorner& b, double t) {
  TetrahedronCorner out;
  for (std::size_t k = 0; k < 3; ++k) out.at[k] = a.at[k] + t * (b.at[k] - a.at[k]);
  out.density = a.density + t * (b.density - a.density);
  return out;
}

// The last axis needs no parts but their volumes.
template <class Visit>
void splitLast(Tetrahedron tet, double volume, openvdb::Coord& voxel, const Visit& visit) {
  const auto order = [&](std::size_t a, std::size_t b) {
    if (tet[b]->at[2] < tet[a]->at[2]) std::swap(tet[a], tet[b]);
  };
  order(0, 1), order(2, 3), order(0, 2), order(1, 3), order(1, 2);
  const double from = tet[0]->at[2], to = tet[3]->at[2];
  VolumeAndMass done;
  double plane = std::floor(from) + 1;
  for (; plane < to; ++plane) {
    const VolumeAndMass below = partBelow(tet, plane);
    if (!(below.volume > done.volume)) continue;  // but for rounding
    voxel[2] = static_cast<int>(plane) - 1;
    visit(voxel, volume * (below.volume - done.volume), volume * (below.mass - done.mass));
    done = below;
  }
  const double mass =
      0.25 * (tet[0]->density + tet[1]->density + tet[2]->density + tet[3]->density);
  voxel[2] = static_cast<int>(plane) - 1;
  visit(voxel, volume * (1 - done.volume), volume * (mass - done.mass));
}

template <std::size_t kAxis, class Visit>
void splitAlong(const Tetrahedron& tet, double volume, openvdb::Coord& voxel, const Visit& visit) {
  if constexpr (kAxis == 2) {
    splitLast(tet, volume, voxel, visit);
  } else {
    std::size_t low = 0, high = 0;
    for (std::size_t k = 1; k < 4; ++k) {
      if (tet[k]->at[kAxis] < tet[low]->at[kAxis]) low = k;
      if (tet[k]->at[kAxis] > tet[high]->at[kAxis]) high = k;
    }
    const double from = tet[low]->at[kAxis], to = tet[high]->at[kAxis];
    const double plane = std::max(std::floor(from) + 1, std::floor(0.5 * (from + to)));
    if (!(plane < to)) {
      voxel[kAxis] = static_cast<int>(std::floor(from));
      return splitAlong<kAxis + 1>(tet, volume, voxel, visit);
    }
    const double t = (plane - from) / (to - from);
    TetrahedronCorner middle = between(*tet[low], *tet[high], t);
    middle.at[kAxis] = plane;  // so that it is on neither side
    Tetrahedron part = tet;
    part[high] = &middle;
    splitAlong<kAxis>(part, t * volume, voxel, visit);
    part[high] = tet[high];
    part[low] = &middle;
    splitAlong<kAxis>(part, volume - t * volume, voxel, visit);
  }
}

}  // namespace detail

// Calls visit(voxel, volume, mass) for parts that make up the tetrahedron, each in one voxel, with
// its share of `volume` (which need not be that of the corners: say, of what they are the image of)
// and the integral over that of the density, which is linear between the corners. A voxel may be
// visited several times. All corners finite, below 1e9.
template <class Visit>
void splitAtVoxels(const Tetrahedron& tet, double volume, const Visit& visit) {
  openvdb::Coord voxel;
  detail::splitAlong<0>(tet, volume, voxel, visit);
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
