// Bounding volume hierarchy over triangles: closest points and pairs that may touch.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

struct LocalTriangles;

struct ClosestPoint {
  SurfacePoint address;  // triangle -1 when nothing is within the search radius
  Vec3 position;
  double distance = std::numeric_limits<double>::infinity();
};

// The closest point of one triangle, its number 0. Exact up to rounding (Ericson, Real-Time
// Collision Detection, 5.1.5).
ClosestPoint closestOnTriangle(const Vec3& p, const std::array<Vec3, 3>& corners);

// Immutable after construction; safe from any number of threads. Keeps copies of the positions.
class TriangleTree {
 public:
  TriangleTree(const Points& vertices, const std::vector<Triangle>& triangles);

  // The closest point of all triangles, if it is nearer than `within`. Exact up to rounding
  // (Ericson, Real-Time Collision Detection, 5.1.5). Among equals the lowest triangle index wins.
  ClosestPoint closest(const Vec3& p,
                       double within = std::numeric_limits<double>::infinity()) const;

  // Whether any triangle is nearer than that: cheaper than where the closest one is.
  bool hasCloser(const Vec3& p, double within) const;

  // Some of the triangles, by the tree's own numbers: searches of many places that lie together
  // need not look at all of them.
  using Part = std::vector<int>;

  // Those that may be as near to p as `within`: all that are, and some more. `part` is replaced.
  void collect(const Vec3& p, double within, Part& part) const;
  void collect(const Vec3& p, double within, const Part& from, Part& part) const;

  // The same as closest() of all, if the part has that one.
  ClosestPoint closest(const Vec3& p, double within, const Part& part) const;

  // Calls visit(part, i, j), i < j, for each pair of triangles whose boxes overlap. Several threads
  // visit at once, each a part of its own below kParts; next() comes between times, when nothing is
  // visited, to collect what the parts hold, and at the end. By parts, and within one, pairs come
  // in an order that does not depend on the number of threads; a part has at most some 16,000
  // between two next().
  static constexpr std::size_t kParts = 256;
  using PairVisitor = std::function<void(std::size_t part, int i, int j)>;
  void overlappingPairs(const PairVisitor& visit, const std::function<void()>& next) const;

  std::size_t size() const;

  // For other searches among the same triangles.
  std::shared_ptr<const LocalTriangles> local() const;

 private:
  struct Implementation;
  std::shared_ptr<const Implementation> implementation_;
};

}  // namespace innermap
