#include "innermap/surface/detail/torus/torus_relaxation.h"

#include <fmt/format.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>

#include "innermap/core/detail/pi.h"
#include "innermap/core/error.h"
#include "innermap/surface/detail/refining/decimate.h"
#include "innermap/surface/detail/refining/progressive_mesh.h"
#include "innermap/surface/detail/refining/rest_triangle.h"
#include "innermap/surface/detail/sphere/star_kernel.h"

namespace innermap {
namespace {

constexpr double kArea = 4 * kPi;      // of the lattice's cell
constexpr std::size_t kCoarsest = 24;  // vertices: a ring around the hole and one around the tube
constexpr double kGrowth = 1.5;        // everything is relaxed when the mesh has grown so much
constexpr double kSlack = 0.02;        // of the mean edge, for slivers' rest shapes
constexpr int kSweeps = 4, kLastSweeps = 12, kFirstSweeps = 60;

// One triangle of a star: q stands at the free vertex, a and b at the others.
struct StarTriangle {
  Vec3 a, b;
  double cotQ, cotA, cotB;  // halves
  double fourAreaSquared;
};

// Symmetric 2 x 2: [xx xy; xy yy].
struct Form {
  double xx = 0, xy = 0, yy = 0;
  double det() const { return xx * yy - xy * xy; }
  void add(const Form& f, double s) {
    xx += s * f.xx;
    xy += s * f.xy;
    yy += s * f.yy;
  }
};

// The S of determinant 1 that is proportional to the one with S g S = m: the geometric mean of the
// inverse of g and m (both positive).
Form balancing(const Form& g, const Form& m) {
  const double dg = g.det(), a = std::sqrt(1 / dg), b = std::sqrt(m.det());
  Form s;
  s.add({g.yy / dg, -g.xy / dg, g.xx / dg}, 1 / a);
  s.add(m, 1 / b);
  const double scale = 1 / std::sqrt(s.det());
  return {scale * s.xx, scale * s.xy, scale * s.yy};
}

class TorusRelaxation {
 public:
  TorusRelaxation(const ClosedSurface& surface, const std::vector<CornerShifts>& shift,
                  Progress* progress)
      : surface_(surface),
        progress_(progress),
        mesh_(surface.vertices.size(), surface.triangles, shift) {
    double area = 0;
    for (const Triangle& t : surface.triangles) {
      const Vec3& a = surface.vertices[t[0]];
      area += 0.5 * norm(cross(surface.vertices[t[1]] - a, surface.vertices[t[2]] - a));
    }
    scale_ = std::sqrt(kArea / area);
    rest_.resize(surface.triangles.size());
  }

  Layout run(const std::vector<CornerShifts>& shift) {
    DecimateSettings coarse;
    coarse.vertices = kCoarsest;
    coarse.progress = progress_;
    decimate(mesh_, surface_.vertices, coarse);
    placeCoarse(shift);
    const std::size_t all = mesh_.capacity();
    double next = kGrowth * static_cast<double>(mesh_.vertexCount());
    while (mesh_.collapses() > 0) {
      const int into = mesh_.lastInto();
      insert(mesh_.split(), into);
      if (static_cast<double>(mesh_.vertexCount()) < next && mesh_.collapses() > 0) continue;
      next = kGrowth * static_cast<double>(mesh_.vertexCount());
      relaxAll(mesh_.collapses() == 0 ? kLastSweeps : kSweeps);
      reportProgress(progress_, "laying out on the torus",
                     static_cast<double>(mesh_.vertexCount()) / static_cast<double>(all));
    }
    for (std::size_t t = 0; t < shift.size(); ++t)
      for (int k = 0; k < 3; ++k) layout_.shift[t][k] = mesh_.shift(static_cast<int>(t), k);
    return std::move(layout_);
  }

 private:
  void placeCoarse(const std::vector<CornerShifts>& shift) {
    std::vector<int> number(mesh_.capacity(), -1), vertexOf;
    std::vector<Triangle> triangles;
    std::vector<CornerShifts> shifts;
    for (int t = 0; t < static_cast<int>(mesh_.triangleCount()); ++t) {
      if (!mesh_.alive(t)) continue;
      Triangle tri = mesh_.triangle(t);
      for (int& v : tri) {
        if (number[v] < 0) {
          number[v] = static_cast<int>(vertexOf.size());
          vertexOf.push_back(v);
        }
        v = number[v];
      }
      triangles.push_back(tri);
      shifts.push_back({mesh_.shift(t, 0), mesh_.shift(t, 1), mesh_.shift(t, 2)});
    }
    const Layout coarse = harmonicTorus(vertexOf.size(), triangles, shifts);
    layout_.space = ModelSpace::torus;
    layout_.place.assign(mesh_.capacity(), {0, 0, 1});
    for (std::size_t i = 0; i < vertexOf.size(); ++i) layout_.place[vertexOf[i]] = coarse.place[i];
    layout_.shift = shift;  // not empty: ringPlaces() then heeds the rings' own
    const double side = std::sqrt(kArea);
    layout_.period = {Vec3{1, 0, 0}, Vec3{0, 1, 0}};
    transform({side, 0, side});
    for (int t = 0; t < static_cast<int>(mesh_.triangleCount()); ++t)
      if (mesh_.alive(t) && !(doubleArea(t) > 0))
        throw DataError(surface_.name +
                        ": rounding leaves no layout of its coarse form on the torus; remove "
                        "slivers and doubled points from the mesh");
    relaxAll(kFirstSweeps);
  }

  Vec3 corner(int t, int k) const {
    return layout_.moved(layout_.place[mesh_.triangle(t)[k]], mesh_.shift(t, k));
  }
  double doubleArea(int t) const { return tripleProduct(corner(t, 0), corner(t, 1), corner(t, 2)); }

  // Upper triangular matrix [xx xy; 0 yy], applied to the whole plane.
  void transform(const Form& m) {
    const auto apply = [&m](Vec3& p) { p = {m.xx * p.x + m.xy * p.y, m.yy * p.y, p.z}; };
    for (Vec3& p : layout_.place) apply(p);
    for (Vec3& p : layout_.period) apply(p);
  }

  double slack() const {
    // Mean edge of as many equilateral triangles on the torus.
    const double area = kArea / (2.0 * static_cast<double>(mesh_.vertexCount()));
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
      const Shift own = mesh_.shift(t, k);
      star_.push_back({layout_.moved(layout_.place[tri[i]], mesh_.shift(t, i) - own),
                       layout_.moved(layout_.place[tri[j]], mesh_.shift(t, j) - own), r.halfCot[k],
                       r.halfCot[i], r.halfCot[j], 4 * r.area * r.area});
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

  // The Hessian made positive.
  Vec3 newtonStep(const Vec3& q) const {
    double gx = 0, gy = 0, hxx = 0, hxy = 0, hyy = 0;
    for (const StarTriangle& t : star_) {
      const double nx = t.a.y - t.b.y, ny = t.b.x - t.a.x;  // the gradient of det
      const double det = tripleProduct(q, t.a, t.b), k = t.fourAreaSquared / (det * det);
      const double dirichlet = t.cotA * squaredNorm(q - t.b) + t.cotB * squaredNorm(q - t.a) +
                               t.cotQ * squaredNorm(t.a - t.b);
      const Vec3 d = 2 * t.cotA * (q - t.b) + 2 * t.cotB * (q - t.a);
      const double slope = -2 * dirichlet * k / det;
      gx += (1 + k) * d.x + slope * nx;
      gy += (1 + k) * d.y + slope * ny;
      const double laplacian = 2 * (t.cotA + t.cotB) * (1 + k), mixed = -2 * k / det,
                   barrier = 6 * dirichlet * k / (det * det);
      hxx += laplacian + 2 * mixed * d.x * nx + barrier * nx * nx;
      hyy += laplacian + 2 * mixed * d.y * ny + barrier * ny * ny;
      hxy += mixed * (d.x * ny + d.y * nx) + barrier * nx * ny;
    }
    const double mean = 0.5 * (hxx + hyy), half = 0.5 * (hxx - hyy);
    const double spread = std::sqrt(half * half + hxy * hxy);
    const double floor = 1e-9 * (std::abs(mean) + spread) + 1e-300;
    const double first = std::max(std::abs(mean + spread), floor),
                 second = std::max(std::abs(mean - spread), floor);
    const double angle = spread > 0 ? 0.5 * std::atan2(hxy, half) : 0;
    const double c = std::cos(angle), s = std::sin(angle);
    const double a = -(c * gx + s * gy) / first, b = -(c * gy - s * gx) / second;
    return {c * a - s * b, s * a + c * b, 0};
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
        const Vec3 to = q + s * step;
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
      balance();
      double won = 0;
      for (int v = 0; v < static_cast<int>(mesh_.capacity()); ++v) {
        if (!mesh_.present(v)) continue;
        won = std::max(won, relax(v, 2));
        if (v % 1024 == 0) throwIfCancelled(progress_);
      }
      if (won < 1e-2) break;
    }
  }

  // The plane's linear map of least energy: with S its square, sum area (|J|^2 + |J^-1|^2) is
  // tr(S g) + tr(S^-1 m), g of the squares of the triangles' J so far, m of their inverses.
  void balance() {
    Form g, m;
    for (int t = 0; t < static_cast<int>(mesh_.triangleCount()); ++t) {
      if (!mesh_.alive(t)) continue;
      const RestTriangle& r = rest_[t];
      Form square;  // twice area J J^T
      for (int k = 0; k < 3; ++k) {
        const Vec3 e = corner(t, (k + 2) % 3) - corner(t, (k + 1) % 3);
        square.add({e.x * e.x, e.x * e.y, e.y * e.y}, r.halfCot[k]);
      }
      const double det = doubleArea(t) / (2 * r.area);
      g.add(square, 1);
      m.add({square.yy, -square.xy, square.xx}, 1 / (det * det));
    }
    if (!(g.det() > 0) || !(m.det() > 0)) return;
    const Form s = balancing(g, m);
    const double x = std::sqrt(s.xx);  // Cholesky: S = U^T U
    transform({x, s.xy / x, 1 / x});
  }

  void insert(int v, int into) {
    mesh_.ring(v, ring_);
    ringPlaces(layout_, ring_, places_);
    for (const int t : mesh_.around(v)) updateRest(t);
    std::size_t w = 0;
    while (ring_[w].vertex != into) ++w;
    Vec3 near;
    if (!placeNear(ModelSpace::torus, places_, w, near))
      throw DataError(fmt::format(
          "{}: no room on the torus for vertex {}; remove slivers and doubled points from the mesh",
          surface_.name, v));
    gather(v);
    Vec3 mean;
    for (const Vec3& p : places_) mean += p;
    mean = mean / static_cast<double>(places_.size());
    mean.z = 1;
    Vec3& place = layout_.place[v];
    place = near;
    double least = energy(near);
    for (const Vec3& candidate : {kernelCentroid(ModelSpace::torus, near, places_), mean}) {
      const double e = energy(candidate);
      if (!(e < least)) continue;
      least = e;
      place = candidate;
    }
    relax(v, 3);
    for (const RingVertex& r : ring_) relax(r.vertex, 1);
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

Layout harmonicTorus(std::size_t vertices, const std::vector<Triangle>& triangles,
                     const std::vector<CornerShifts>& shift) {
  // Each edge is met from both sides; vertex 0 stays at the origin.
  const auto n = static_cast<Eigen::Index>(vertices);
  std::vector<Eigen::Triplet<double>> entries{{0, 0, 1.0}};
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n, 2);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int j = (k + 1) % 3, from = triangles[t][k], to = triangles[t][j];
      if (from == 0) continue;
      const Shift s = shift[t][j] - shift[t][k];
      entries.emplace_back(from, from, 1.0);
      if (to != 0) entries.emplace_back(from, to, -1.0);
      right(from, 0) += s.a;
      right(from, 1) += s.b;
    }
  }
  Eigen::SparseMatrix<double> laplacian(n, n);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(laplacian);
  const Eigen::MatrixXd place = solver.solve(right);
  Layout layout;
  layout.space = ModelSpace::torus;
  layout.period = {Vec3{1, 0, 0}, Vec3{0, 1, 0}};
  layout.shift = shift;
  for (Eigen::Index v = 0; v < n; ++v) layout.place.push_back({place(v, 0), place(v, 1), 1});
  return layout;
}

Layout relaxedTorus(const ClosedSurface& surface, const std::vector<CornerShifts>& shift,
                    Progress* progress) {
  return TorusRelaxation(surface, shift, progress).run(shift);
}

}  // namespace innermap
