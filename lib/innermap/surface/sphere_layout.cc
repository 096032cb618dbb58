#include "innermap/surface/sphere_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "innermap/core/error.h"
#include "innermap/surface/decimate.h"
#include "innermap/surface/progressive_mesh.h"
#include "innermap/surface/rest_triangle.h"
#include "innermap/surface/star_kernel.h"

namespace innermap {
namespace {

constexpr double kGrowth = 1.5;  // everything is relaxed when the mesh has grown so much
constexpr double kSlack = 0.02;  // of the mean edge, for slivers' rest shapes
constexpr int kSweeps = 4, kLastSweeps = 12;

// One triangle of a star: q stands at the free vertex, a and b at the others.
struct StarTriangle {
  Vec3 a, b;
  double cotQ, cotA, cotB;  // halves
  double fourAreaSquared;
};

class SphereRelaxation {
 public:
  SphereRelaxation(const ClosedSurface& surface, Progress* progress)
      : surface_(surface), progress_(progress), mesh_(surface.vertices.size(), surface.triangles) {
    double area = 0;
    for (const Triangle& t : surface.triangles) area += 0.5 * norm(normalOf(t));
    scale_ = std::sqrt(4 * std::acos(-1.0) / area);
    rest_.resize(surface.triangles.size());
    layout_.place.resize(surface.vertices.size());
  }

  Layout run() {
    DecimateSettings coarse;
    coarse.progress = progress_;
    decimate(mesh_, surface_.vertices, coarse);
    if (mesh_.vertexCount() != 4)
      throw DataError(surface_.name +
                      ": cannot be coarsened to a tetrahedron, so it is not one closed surface "
                      "without handles (see innermap check)");
    placeTetrahedron();
    const std::size_t all = mesh_.capacity();
    double next = 4 * kGrowth;
    while (mesh_.collapses() > 0) {
      const int into = mesh_.lastInto();
      const int v = mesh_.split();
      insert(v, into);
      if (static_cast<double>(mesh_.vertexCount()) < next && mesh_.collapses() > 0) continue;
      next = kGrowth * static_cast<double>(mesh_.vertexCount());
      relaxAll(mesh_.collapses() == 0 ? kLastSweeps : kSweeps);
      reportProgress(progress_, "laying out on the sphere",
                     static_cast<double>(mesh_.vertexCount()) / static_cast<double>(all));
    }
    return std::move(layout_);
  }

 private:
  Vec3 normalOf(const Triangle& t) const {
    const Vec3& a = surface_.vertices[t[0]];
    return cross(surface_.vertices[t[1]] - a, surface_.vertices[t[2]] - a);
  }

  void placeTetrahedron() {
    int alive = 0;
    while (!mesh_.alive(alive)) ++alive;
    const Triangle base = mesh_.triangle(alive);
    const double s = 1 / std::sqrt(3.0);
    const Vec3 corners[4] = {{s, s, s}, {-s, -s, s}, {-s, s, -s}, {s, -s, -s}};
    const bool turned = tripleProduct(corners[0], corners[1], corners[2]) < 0;
    for (int v = 0; v < static_cast<int>(mesh_.capacity()); ++v)
      if (mesh_.present(v)) layout_.place[v] = corners[3];
    for (int k = 0; k < 3; ++k) layout_.place[base[k]] = corners[turned ? 2 - k : k];
    for (int t = 0; t < static_cast<int>(mesh_.triangleCount()); ++t)
      if (mesh_.alive(t)) updateRest(t);
  }

  double slack() const {
    // Mean edge of as many equilateral triangles on the sphere.
    const double area = 4 * std::acos(-1.0) / (2.0 * static_cast<double>(mesh_.vertexCount()));
    return kSlack * std::sqrt(4 * area / std::sqrt(3.0));
  }

  void updateRest(int t) {
    const Triangle& tri = mesh_.triangle(t);
    rest_[t] =
        RestTriangle::of(scale_ * surface_.vertices[tri[0]], scale_ * surface_.vertices[tri[1]],
                         scale_ * surface_.vertices[tri[2]], slack());
  }

  void gather(int v) {
    star_.clear();
    for (const int t : mesh_.around(v)) {
      const Triangle& tri = mesh_.triangle(t);
      const int k = tri[0] == v ? 0 : tri[1] == v ? 1 : 2, i = (k + 1) % 3, j = (k + 2) % 3;
      const RestTriangle& r = rest_[t];
      star_.push_back({layout_.place[tri[i]], layout_.place[tri[j]], r.halfCot[k], r.halfCot[i],
                       r.halfCot[j], 4 * r.area * r.area});
    }
  }

  // Infinite where a triangle is not positive.
  double energy(const Vec3& q) const {
    double sum = 0;
    for (const StarTriangle& t : star_) {
      const double det = tripleProduct(q, t.a, t.b);
      if (!(det > 0)) return std::numeric_limits<double>::infinity();
      const double dirichlet = t.cotA * squaredNorm(q - t.b) + t.cotB * squaredNorm(q - t.a) +
                               t.cotQ * squaredNorm(t.a - t.b);
      sum += dirichlet * (1 + t.fourAreaSquared / (det * det));
    }
    return sum;
  }

  // Gradient and Hessian in tangent coordinates; the Hessian made positive.
  Vec3 newtonStep(const Vec3& q) const {
    Vec3 gradient;
    const Tangent tangent = tangentAt(ModelSpace::sphere, q);
    double huu = 0, huv = 0, hvv = 0;
    for (const StarTriangle& t : star_) {
      const Vec3 n = cross(t.a, t.b - t.a);
      const double det = tripleProduct(q, t.a, t.b), k = t.fourAreaSquared / (det * det);
      const double dirichlet = t.cotA * squaredNorm(q - t.b) + t.cotB * squaredNorm(q - t.a) +
                               t.cotQ * squaredNorm(t.a - t.b);
      const Vec3 d = 2 * t.cotA * (q - t.b) + 2 * t.cotB * (q - t.a);
      gradient += (1 + k) * d - (2 * dirichlet * k / det) * n;
      const double nu = dot(n, tangent.u), nv = dot(n, tangent.v);
      const double du = dot(d, tangent.u), dv = dot(d, tangent.v);
      const double laplacian = 2 * (t.cotA + t.cotB) * (1 + k), mixed = -2 * k / det,
                   barrier = 6 * dirichlet * k / (det * det);
      huu += laplacian + 2 * mixed * du * nu + barrier * nu * nu;
      hvv += laplacian + 2 * mixed * dv * nv + barrier * nv * nv;
      huv += mixed * (du * nv + dv * nu) + barrier * nu * nv;
    }
    const double curvature = dot(gradient, q);  // of the sphere, which the point moves along
    huu -= curvature;
    hvv -= curvature;
    const double gu = dot(gradient, tangent.u), gv = dot(gradient, tangent.v);
    const double mean = 0.5 * (huu + hvv), half = 0.5 * (huu - hvv);
    const double spread = std::sqrt(half * half + huv * huv);
    const double floor = 1e-9 * (std::abs(mean) + spread) + 1e-300;
    const double first = std::max(std::abs(mean + spread), floor),
                 second = std::max(std::abs(mean - spread), floor);
    double cu = 1, cv = 0;  // eigenvector of mean + spread
    if (spread > 0) {
      const double angle = 0.5 * std::atan2(huv, half);
      cu = std::cos(angle);
      cv = std::sin(angle);
    }
    const double a = -(cu * gu + cv * gv) / first, b = -(-cv * gu + cu * gv) / second;
    return (cu * a - cv * b) * tangent.u + (cv * a + cu * b) * tangent.v;
  }

  // Newton with backtracking; the share of the energy that was won.
  double relax(int v, int steps) {
    gather(v);
    Vec3& q = layout_.place[v];
    double now = energy(q);
    const double start = now;
    for (int i = 0; i < steps; ++i) {
      Vec3 step = newtonStep(q);
      const double length = norm(step);
      if (!(length > 1e-14)) break;
      if (length > 0.5) step = (0.5 / length) * step;
      const double before = now;
      double s = 1;
      for (int k = 0; k < 12; ++k, s *= 0.4) {
        const Vec3 to = moveAlong(ModelSpace::sphere, q, s * step);
        const double e = energy(to);
        if (e < now) {
          q = to;
          now = e;
          break;
        }
      }
      if (!(now < before * (1 - 1e-3))) break;
    }
    return start > 0 ? 1 - now / start : 0;
  }

  void relaxAll(int sweeps) {
    for (int t = 0; t < static_cast<int>(mesh_.triangleCount()); ++t)
      if (mesh_.alive(t)) updateRest(t);
    for (int s = 0; s < sweeps; ++s) {
      double won = 0;
      for (int v = 0; v < static_cast<int>(mesh_.capacity()); ++v) {
        if (!mesh_.present(v)) continue;
        won = std::max(won, relax(v, 2));
        if (v % 1024 == 0) throwIfCancelled(progress_);
      }
      if (won < 1e-2) break;
    }
  }

  void insert(int v, int into) {
    mesh_.ring(v, ring_);
    ringPlaces(layout_, ring_, places_);
    for (const int t : mesh_.around(v)) updateRest(t);
    std::size_t w = 0;
    while (ring_[w].vertex != into) ++w;
    Vec3 place;
    if (!placeNear(ModelSpace::sphere, places_, w, place))
      throw DataError(
          fmt::format("{}: no room on the sphere for vertex {}; remove slivers and "
                      "doubled points from the mesh",
                      surface_.name, v));
    choosePlace(v, place);
    relax(v, 3);
    for (const RingVertex& r : ring_) relax(r.vertex, 1);
  }

  // The best of: near its parent, the kernel's centroid, the ring's mean.
  void choosePlace(int v, const Vec3& near) {
    gather(v);
    Vec3 mean;
    for (const Vec3& p : places_) mean += p;
    mean = mean / std::max(norm(mean), 1e-300);
    Vec3& place = layout_.place[v];
    place = near;
    double least = energy(near);
    for (const Vec3& candidate : {kernelCentroid(ModelSpace::sphere, near, places_), mean}) {
      const double e = energy(candidate);
      if (!(e < least)) continue;
      least = e;
      place = candidate;
    }
  }

  const ClosedSurface& surface_;
  Progress* progress_;
  ProgressiveMesh mesh_;
  double scale_ = 1;
  std::vector<RestTriangle> rest_;
  Layout layout_;
  std::vector<StarTriangle> star_;
  Ring ring_;
  RingPlaces places_;
};

}  // namespace

Layout layOutSphere(const ClosedSurface& surface, const SphereLayoutSettings& settings) {
  return SphereRelaxation(surface, settings.progress).run();
}

}  // namespace innermap
