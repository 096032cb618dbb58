#include "surface/detail/torus/torus_relaxation.h"

#include <fmt/format.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cmath>

#include "core/pi.h"
#include "innermap/core/error.h"
#include "surface/detail/refining/coarse_to_fine.h"
#include "surface/detail/refining/decimate.h"
#include "surface/detail/refining/newton_step.h"
#include "surface/detail/refining/progressive_mesh.h"
#include "surface/detail/refining/rest_triangle.h"
#include "surface/detail/refining/star_stretch.h"

namespace innermap {
namespace {

constexpr double kArea = 4 * kPi;      // of the lattice's cell
constexpr std::size_t kCoarsest = 24;  // vertices: a ring around the hole and one around the tube
constexpr double kSlack = 0.02;        // of the mean edge, for slivers' rest shapes
constexpr int kFirstSweeps = 60;

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

// The plane is balanced by a linear map before each sweep.
class TorusEnergy : public StarEnergy {
 public:
  TorusEnergy(const ClosedSurface& surface, const ProgressiveMesh& mesh, Layout& layout)
      : surface_(surface),
        mesh_(mesh),
        layout_(layout),
        scale_(std::sqrt(kArea / surfaceArea(surface.vertices, surface.triangles))),
        rest_(surface.triangles.size()) {}

  // Upper triangular matrix [xx xy; 0 yy], applied to the whole plane.
  void transform(const Form& m) {
    const auto apply = [&m](Vec3& p) { p = {m.xx * p.x + m.xy * p.y, m.yy * p.y, p.z}; };
    for (Vec3& p : layout_.place) apply(p);
    for (Vec3& p : layout_.period) apply(p);
  }

  double doubleArea(int t) const { return tripleProduct(corner(t, 0), corner(t, 1), corner(t, 2)); }

  void changed(int t) override {
    const Triangle& tri = mesh_.triangle(t);
    rest_[t] =
        RestTriangle::of(scale_ * surface_.vertices[tri[0]], scale_ * surface_.vertices[tri[1]],
                         scale_ * surface_.vertices[tri[2]], slack());
  }

  bool sweeps() override {
    balance();
    return true;
  }

  std::unique_ptr<Star> star() const override;

 private:
  class TorusStar;

  Vec3 corner(int t, int k) const {
    return layout_.moved(layout_.place[mesh_.triangle(t)[k]], mesh_.shift(t, k));
  }

  double slack() const {
    // Mean edge of as many equilateral triangles on the torus.
    const double area = kArea / (2.0 * static_cast<double>(mesh_.vertexCount()));
    return kSlack * std::sqrt(4 * area / std::sqrt(3.0));
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

  const ClosedSurface& surface_;
  const ProgressiveMesh& mesh_;
  Layout& layout_;
  double scale_;
  std::vector<RestTriangle> rest_;
};

class TorusEnergy::TorusStar : public Star {
 public:
  explicit TorusStar(const TorusEnergy& energy) : energy_(energy) {}

  void gather(int v) override {
    star_.clear();
    const ProgressiveMesh& mesh = energy_.mesh_;
    const Layout& layout = energy_.layout_;
    for (const int t : mesh.around(v)) {
      const Triangle& tri = mesh.triangle(t);
      const int k = tri[0] == v ? 0 : tri[1] == v ? 1 : 2, i = (k + 1) % 3, j = (k + 2) % 3;
      const RestTriangle& r = energy_.rest_[t];
      const Shift own = mesh.shift(t, k);
      star_.push_back({layout.moved(layout.place[tri[i]], mesh.shift(t, i) - own),
                       layout.moved(layout.place[tri[j]], mesh.shift(t, j) - own), r.halfCot[k],
                       r.halfCot[i], r.halfCot[j], 4 * r.area * r.area});
    }
  }

  double at(const Vec3& q) const override { return stretchEnergy(star_, q); }

  Vec3 step(const Vec3& q, double) const override {
    double gx = 0, gy = 0, hxx = 0, hxy = 0, hyy = 0;
    for (const StarTriangle& t : star_) {
      const double nx = t.a.y - t.b.y, ny = t.b.x - t.a.x;  // the gradient of det
      const double det = tripleProduct(q, t.a, t.b), k = t.fourAreaSquared / (det * det);
      const double dirichlet = t.dirichlet(q);
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
    const Vec2 s = newtonStep(gx, gy, hxx, hxy, hyy);
    const Vec3 step{s.x, s.y, 0};
    const double length = norm(step);
    return length > 0.5 ? (0.5 / length) * step : step;
  }

 private:
  const TorusEnergy& energy_;
  std::vector<StarTriangle> star_;
};

std::unique_ptr<Star> TorusEnergy::star() const { return std::make_unique<TorusStar>(*this); }

// The layout of the coarse form with the least sum of squared edges, on a square.
Layout coarseLayout(const ProgressiveMesh& mesh, const std::vector<CornerShifts>& shift) {
  std::vector<int> number(mesh.capacity(), -1), vertexOf;
  std::vector<Triangle> triangles;
  std::vector<CornerShifts> shifts;
  for (int t = 0; t < static_cast<int>(mesh.triangleCount()); ++t) {
    if (!mesh.alive(t)) continue;
    Triangle tri = mesh.triangle(t);
    for (int& v : tri) {
      if (number[v] < 0) {
        number[v] = static_cast<int>(vertexOf.size());
        vertexOf.push_back(v);
      }
      v = number[v];
    }
    triangles.push_back(tri);
    shifts.push_back({mesh.shift(t, 0), mesh.shift(t, 1), mesh.shift(t, 2)});
  }
  const Layout coarse = harmonicTorus(vertexOf.size(), triangles, shifts);
  Layout layout;
  layout.space = ModelSpace::torus;
  layout.place.assign(mesh.capacity(), {0, 0, 1});
  for (std::size_t i = 0; i < vertexOf.size(); ++i) layout.place[vertexOf[i]] = coarse.place[i];
  layout.shift = shift;  // not empty: ringPlaces() then heeds the rings' own
  layout.period = {Vec3{1, 0, 0}, Vec3{0, 1, 0}};
  return layout;
}

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

Layout relaxedTorus(const ClosedSurface& surface, const std::vector<CornerShifts>& shift) {
  ProgressiveMesh mesh(surface.vertices.size(), surface.triangles, shift);
  DecimateSettings coarse;
  coarse.vertices = kCoarsest;
  decimate(mesh, surface.vertices, coarse);
  Layout layout = coarseLayout(mesh, shift);
  TorusEnergy energy(surface, mesh, layout);
  const double side = std::sqrt(kArea);
  energy.transform({side, 0, side});
  for (int t = 0; t < static_cast<int>(mesh.triangleCount()); ++t)
    if (mesh.alive(t) && !(energy.doubleArea(t) > 0))
      throw DataError(surface.name +
                      ": rounding leaves no layout of its coarse form on the torus; remove "
                      "slivers and doubled points from the mesh");
  RelaxSettings relax;
  relax.enough = 1e-2;
  relax.stage = "laying out on the torus";
  CoarseToFine fine(mesh, layout, energy, {}, relax);
  fine.relaxAll(kFirstSweeps);
  const int stuck = fine.refine(mesh.capacity());
  if (stuck >= 0)
    throw DataError(fmt::format(
        "{}: no room on the torus for vertex {}; remove slivers and doubled points from the mesh",
        surface.name, stuck));
  for (std::size_t t = 0; t < shift.size(); ++t)
    for (int k = 0; k < 3; ++k) layout.shift[t][k] = mesh.shift(static_cast<int>(t), k);
  return layout;
}

}  // namespace innermap
