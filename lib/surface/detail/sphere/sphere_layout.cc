#include "surface/detail/sphere/sphere_layout.h"

#include <fmt/format.h>

#include <cmath>

#include "core/pi.h"
#include "innermap/core/error.h"
#include "surface/detail/refining/coarse_to_fine.h"
#include "surface/detail/refining/decimate.h"
#include "surface/detail/refining/newton_step.h"
#include "surface/detail/refining/rest_triangle.h"
#include "surface/detail/refining/star_stretch.h"
#include "surface/detail/refining/target_metric.h"

namespace innermap {
namespace {

constexpr double kSphereArea = 4 * kPi;

class SphereEnergy : public StarEnergy {
 public:
  SphereEnergy(const ClosedSurface& surface, const ProgressiveMesh& mesh, const Layout& layout)
      : mesh_(mesh), layout_(layout), points_(surface.vertices), rest_(surface.triangles.size()) {
    const double scale = std::sqrt(kSphereArea) * unitAreaScale(points_, surface.triangles);
    const Vec3 center = boundingBox(points_).center();
    for (Vec3& p : points_) p = scale * (p - center);
  }

  void grown(std::size_t vertices) override {
    const double area = kSphereArea / (2.0 * static_cast<double>(vertices));
    slack_ = 0.02 * std::sqrt(4 * area / std::sqrt(3.0));  // of an equilateral triangle's edge
  }

  void changed(int t) override {
    const Triangle& tri = mesh_.triangle(t);
    rest_[t] = RestTriangle::of(points_[tri[0]], points_[tri[1]], points_[tri[2]], slack_);
  }

  std::unique_ptr<Star> star() const override;

 private:
  class SphereStar;

  const ProgressiveMesh& mesh_;
  const Layout& layout_;
  Points points_;
  double slack_ = 0;
  std::vector<RestTriangle> rest_;
};

class SphereEnergy::SphereStar : public Star {
 public:
  explicit SphereStar(const SphereEnergy& energy) : energy_(energy) {}

  void gather(int v) override {
    star_.clear();
    const Points& place = energy_.layout_.place;
    for (const int t : energy_.mesh_.around(v)) {
      const Triangle& tri = energy_.mesh_.triangle(t);
      const int k = tri[0] == v ? 0 : tri[1] == v ? 1 : 2, i = (k + 1) % 3, j = (k + 2) % 3;
      const RestTriangle& r = energy_.rest_[t];
      star_.push_back({place[tri[i]], place[tri[j]], r.halfCot[k], r.halfCot[i], r.halfCot[j],
                       4 * r.area * r.area});
    }
  }

  double at(const Vec3& q) const override { return stretchEnergy(star_, q); }

  Vec3 step(const Vec3& q, double) const override {
    Vec3 gradient;
    const Tangent tangent = tangentAt(ModelSpace::sphere, q);
    double huu = 0, huv = 0, hvv = 0;
    for (const StarTriangle& t : star_) {
      const Vec3 n = cross(t.a, t.b - t.a);
      const double det = tripleProduct(q, t.a, t.b), k = t.fourAreaSquared / (det * det);
      const double dirichlet = t.dirichlet(q);
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
    const Vec2 s = newtonStep(dot(gradient, tangent.u), dot(gradient, tangent.v), huu - curvature,
                              huv, hvv - curvature);
    const Vec3 step = s.x * tangent.u + s.y * tangent.v;
    const double length = norm(step);
    return length > 0.5 ? (0.5 / length) * step : step;
  }

 private:
  const SphereEnergy& energy_;
  std::vector<StarTriangle> star_;
};

std::unique_ptr<Star> SphereEnergy::star() const { return std::make_unique<SphereStar>(*this); }

void placeTetrahedron(const ProgressiveMesh& mesh, Layout& layout) {
  int alive = 0;
  while (!mesh.alive(alive)) ++alive;
  const Triangle base = mesh.triangle(alive);
  const double s = 1 / std::sqrt(3.0);
  const Vec3 corners[4] = {{s, s, s}, {-s, -s, s}, {-s, s, -s}, {s, -s, -s}};
  const bool turned = tripleProduct(corners[0], corners[1], corners[2]) < 0;
  for (int v = 0; v < static_cast<int>(mesh.capacity()); ++v)
    if (mesh.present(v)) layout.place[v] = corners[3];
  for (int k = 0; k < 3; ++k) layout.place[base[k]] = corners[turned ? 2 - k : k];
}

}  // namespace

Layout layOutSphere(const ClosedSurface& surface) {
  ProgressiveMesh mesh(surface.vertices.size(), surface.triangles);
  DecimateSettings coarse;
  decimate(mesh, surface.vertices, coarse);
  if (mesh.vertexCount() != 4)
    throw DataError(surface.name +
                    ": cannot be coarsened to a tetrahedron, so it is not one closed surface "
                    "without handles (see innermap check)");
  Layout layout;
  layout.place.resize(surface.vertices.size());
  placeTetrahedron(mesh, layout);
  SphereEnergy energy(surface, mesh, layout);
  RelaxSettings relax;
  relax.stage = "laying out on the sphere";
  CoarseToFine fine(mesh, layout, energy, {}, relax);
  fine.relaxAll(1);
  const int stuck = fine.refine(surface.vertices.size());
  if (stuck >= 0)
    throw DataError(
        fmt::format("{}: no room on the sphere for vertex {}; remove slivers and "
                    "doubled points from the mesh",
                    surface.name, stuck));
  return layout;
}

}  // namespace innermap
