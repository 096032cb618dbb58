// Which triangle of a layout a ray passes through.
#pragma once

#include <algorithm>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/surface/correspond.h"
#include "surface/detail/topology/adjacency.h"

namespace innermap {

// The triangle, moved by `shift` (torus), that contains a point.
struct Located {
  int triangle = -1;
  Shift shift;
};

// Randomised visibility walk (Devillers, Pion, Teillaud, "Walking in a triangulation", 2002) from a
// hint, or from a table of hints over the space; every triangle in turn where that fails. The
// layout must be valid. Immutable; safe from any number of threads.
class Locator {
 public:
  using Weights = std::array<double, 3>;  // barycentric but for a factor

  // The cone over a triangle's corners. side[k] = a x (b - a) for the edge a b opposite corner k,
  // which rounding leaves exact for short edges too.
  struct Cone {
    Vec3 side[3];
    int next[3] = {};  // the triangle beyond each side

    Weights weights(const Vec3& p) const {
      return {dot(p, side[0]), dot(p, side[1]), dot(p, side[2])};
    }
  };

  Locator(const std::vector<Triangle>& triangles, const Layout& layout);

  // p: a ray near unit length, or a point of the plane z = 1. weights: its own in what is found.
  Located find(const Vec3& p, const Located& hint, Weights& weights) const {
    weights = cones_[hint.triangle].weights(local(p, hint));
    const double least = std::min(std::min(weights[0], weights[1]), weights[2]);
    return least >= 0 ? hint : walk(p, hint, weights);
  }
  Located find(const Vec3& p, const Located& hint) const {
    Weights weights;
    return find(p, hint, weights);
  }
  Located find(const Vec3& p) const { return find(p, hintFor(p)); }
  Located find(const Vec3& p, Weights& weights) const { return find(p, hintFor(p), weights); }

  // Barycentric coordinates in [0, 1] of the point in the triangle found, sum 1.
  std::array<double, 3> barycentric(const Vec3& p, const Located& where) const;

  const Cone& cone(int triangle) const { return cones_[triangle]; }
  // p in the frame of the triangle's own copy.
  Vec3 local(const Vec3& p, const Located& where) const {
    return periodic_ ? p - offset(where.shift) : p;
  }
  std::size_t size() const { return cones_.size(); }

 private:
  Vec3 offset(const Shift& s) const {
    return static_cast<double>(s.a) * period_[0] + static_cast<double>(s.b) * period_[1];
  }
  Located hintFor(const Vec3& p) const;
  Located walk(const Vec3& p, const Located& hint, Weights& weights) const;
  Located search(const Vec3& p, const Located& hint) const;
  Vec3 cellCenter(std::size_t cell) const;
  std::size_t cellOf(const Vec3& p, Shift* shift) const;

  bool periodic_ = false;
  std::array<Vec3, 2> period_{};
  std::vector<Cone> cones_;
  int longestWalk_ = 0;                         // steps, before all triangles are tried
  std::vector<std::array<Shift, 3>> crossing_;  // torus: of the frame, across each edge
  int cells_ = 1;                               // along each side of the table
  std::vector<Located> hints_;
};

}  // namespace innermap
