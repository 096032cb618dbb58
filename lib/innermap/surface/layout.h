// A closed surface, and how it is laid out on a model space: the unit sphere, or the plane modulo a
// lattice (the flat torus). One description serves both: points are rays from the origin, triangles
// are cones over three rays, and on the torus all points have z = 1, where rays are plane points.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

struct ClosedSurface {
  std::string name;                 // what error messages should call it
  Points vertices;                  // #V, world units; each is used by some triangle
  std::vector<Triangle> triangles;  // #T; each edge has two, running opposite ways; outward of the
                                    // solid (so a cavity's shell has a negative volume)
  int genus = 0;                    // handles: #V - #E + #T = 2 - 2 genus
};

enum class ModelSpace { sphere, torus };

// A translation of the plane by a * period[0] + b * period[1].
struct Shift {
  int a = 0, b = 0;
};

inline Shift operator+(const Shift& s, const Shift& t) { return {s.a + t.a, s.b + t.b}; }
inline Shift operator-(const Shift& s, const Shift& t) { return {s.a - t.a, s.b - t.b}; }
inline bool operator==(const Shift& s, const Shift& t) { return s.a == t.a && s.b == t.b; }

using CornerShifts = std::array<Shift, 3>;

// Of a ClosedSurface, whose triangles it belongs to. A layout is valid when each triangle's corners
// p, q, r have det(p, q, r) > 0: then it is one-to-one (degree 1), as the triangles cover the space
// once.
struct Layout {
  ModelSpace space = ModelSpace::sphere;
  Points place;  // #V; sphere: unit vectors; torus: (x, y, 1)

  // Torus only. period[0] is the lattice vector of the meridian, period[1] that of the longitude,
  // both with z = 0 and det(period[0], period[1]) > 0 in the plane. Corner k of triangle t stands
  // at place[triangles[t][k]] moved by shift[t][k].
  std::array<Vec3, 2> period{};
  std::vector<CornerShifts> shift;  // #T; empty on the sphere

  Vec3 moved(const Vec3& p, const Shift& s) const {
    return p + (static_cast<double>(s.a) * period[0] + static_cast<double>(s.b) * period[1]);
  }
  Vec3 corner(const std::vector<Triangle>& triangles, int t, int k) const {
    const Vec3& p = place[triangles[t][k]];
    return shift.empty() ? p : moved(p, shift[t][k]);
  }
};

// Of three rays: six times the signed volume of the cone; positive where a layout is valid.
inline double tripleProduct(const Vec3& p, const Vec3& q, const Vec3& r) {
  return dot(p, cross(q - p, r - p));
}

struct LayoutQuality {
  std::size_t flips = 0;      // triangles with tripleProduct not above 0
  double degree = 0;          // signed area covered over that of the space; 1 when valid
  double areaRatioLog10 = 0;  // the least log10 of (a triangle's share of the space / its share of
                              // the surface), over triangles that have area
};

LayoutQuality layoutQuality(const std::vector<Triangle>& triangles, const Points& vertices,
                            const Layout& layout);

// Of several shells: all flips, the degree farthest from 1, the least ratio.
LayoutQuality together(const std::vector<LayoutQuality>& shells);

// Judges maps of a shell by more than the two surfaces: by the inside, say.
struct MapJudge {
  std::vector<SurfacePoint> at;                       // of A's shell
  std::function<double(const Points& images)> score;  // of `at`, world units on B; less is better
};

// Which way round one surface is laid on another, of those that a judge heard.
struct WantedWay {
  int choose = 1;       // by preference: the best, then the next that differs, ...
  bool mirror = false;  // instead: the best that turns left into right, as `choose` = 1 does not
};

// A map that was considered.
struct ConsideredMap {
  std::string origin;  // how it was found, in words
  double energy = 0;   // of a coarse surface, both ways
  double score = 0;    // the judge's, of that
  double turn = 0;     // degrees of the rotation nearest to it, in [0, 180]
  int way = 1;         // maps that put A's parts at about the same places are one way round
};

// Another way round that a judge finds as good as the one that was taken.
struct OtherWay {
  int way = 2;
  std::array<double, 2> score{}, turn{};  // of the one taken and of this one
  ClosedSurface surface;                  // A's shell, coarse
  Layout image;                           // of it
};

}  // namespace innermap
