// Meshes and harmonic maps of their insides that are known, for the certificate to be held against.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "fit/test_pairs.h"
#include "innermap/fit/fit_map.h"
#include "innermap/fit/surface_problem.h"
#include "innermap/mesh/mesh_file.h"
#include "sample/surface_samples.h"

namespace innermap::known {

using Function = std::function<Vec3(const Vec3&)>;

struct NamedMesh {
  std::string name;
  Mesh mesh;
};

struct NamedFunction {
  std::string name;
  Function f;
};

// A charge's potential times `size`, pushing along x, y and z unlike. `at` outside the solid.
inline Function charge(const Vec3& at, double size) {
  return [=](const Vec3& p) {
    const Vec3 d = p - at;
    const double r = norm(d);
    return p + size * Vec3{1 / r, -d.x / (r * r * r), 0.5 / r};
  };
}

inline Vec3 cubic(const Vec3& p) {
  return p + 0.1 * Vec3{p.x * p.x * p.x - 3 * p.x * p.y * p.y, p.x * p.y * p.z,
                        2 * p.z * p.z * p.z - 3 * p.z * (p.x * p.x + p.y * p.y)};
}

inline Vec3 wave(const Vec3& p) {
  return p + 0.05 * Vec3{std::exp(2 * p.x) * std::sin(2 * p.y),
                         std::exp(3 * p.z) * std::cos(3 * p.x),
                         std::sin(2 * p.y) * std::sinh(2 * p.z)};
}

// The charges are this far from the solid's rightmost vertex along x.
inline std::vector<NamedFunction> functionsOn(const Mesh& mesh) {
  Vec3 tip = mesh.vertices[0];
  for (const Vec3& p : mesh.vertices)
    if (p.x > tip.x) tip = p;
  return {{"affine", affineMap},
          {"quadratic", harmonicPolynomial},
          {"cubic", cubic},
          {"wave", wave},
          {"far charge", charge(tip + Vec3{1.5, 1, 0.5}, 0.5)},
          {"near charge", charge(tip + Vec3{0.3, 0.2, 0.15}, 0.1)},
          {"pole", charge(tip + Vec3{0.12, 0.05, 0.02}, 0.03)}};
}

// A cube of half edge 0.7 with `n` by `n` squares a face.
inline Mesh gridBox(int n) {
  Mesh mesh;
  std::map<std::array<int, 3>, int> known;
  const auto vertex = [&](std::array<int, 3> at) {
    const auto [found, isNew] = known.try_emplace(at, static_cast<int>(mesh.vertices.size()));
    if (isNew)
      mesh.vertices.push_back((0.7 / n) * Vec3{2.0 * at[0] - n, 2.0 * at[1] - n, 2.0 * at[2] - n});
    return found->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int di, int dj) {
            std::array<int, 3> at{};
            at[axis] = side;
            at[(axis + 1) % 3] = i + di;
            at[(axis + 2) % 3] = j + dj;
            return vertex(at);
          };
          Triangle a{corner(0, 0), corner(1, 0), corner(1, 1)},
              b{corner(0, 0), corner(1, 1), corner(0, 1)};
          if (side == 0) std::swap(a[1], a[2]), std::swap(b[1], b[2]);
          mesh.triangles.push_back(a);
          mesh.triangles.push_back(b);
        }
  return mesh;
}

// One of ../shared/models without holes (no function of theirs is known on caps), its middle at the
// origin, 2.5 diagonally; none where there are none.
inline std::vector<NamedMesh> model(const std::string& name) {
  const std::string path = std::string(INNERMAP_MODELS) + "/" + name + ".obj";
  if (!std::filesystem::exists(path)) return {};
  Mesh mesh = readMesh(path);
  const Box3 box = boundingBox(mesh);
  for (Vec3& p : mesh.vertices) p = (2.5 / box.diagonal()) * (p - box.center());
  return {{name, mesh}};
}

// All about the origin and about 2 across.
inline std::vector<NamedMesh> meshes() {
  Mesh needle = shapes::icosphere(4);
  for (Vec3& p : needle.vertices) p = {p.x, 0.1 * p.y, 0.08 * p.z};
  std::vector<NamedMesh> out = {
      {"ball", shapes::icosphere(4)},
      {"torus", shapes::torus(48, 24, 0.75, 0.3)},
      {"box", gridBox(10)},
      {"hollow ball",
       shapes::joined(shapes::icosphere(4), shapes::flipped(shapes::icosphere(3, 0.5)))},
      {"needle", needle}};
  for (const NamedMesh& m : model("spot")) out.push_back(m);
  return out;
}

inline std::vector<NamedMesh> moreMeshes() {
  Mesh bean = shapes::icosphere(4);
  for (Vec3& p : bean.vertices) p = {p.x, 0.5 * p.y + 0.3 * p.x * p.x, 0.6 * p.z};
  Mesh lumps = shapes::icosphere(4);
  for (Vec3& p : lumps.vertices)
    p = (0.8 + 0.15 * std::sin(5 * p.x) * std::cos(4 * p.y) + 0.05 * std::sin(9 * p.z)) * p;
  Mesh plate = shapes::icosphere(4);
  for (Vec3& p : plate.vertices) p = {p.x, p.y, 0.05 * p.z};
  std::vector<NamedMesh> out = {{"coarse ball", shapes::icosphere(3)},
                                {"coarse torus", shapes::torus(24, 12, 0.75, 0.3)},
                                {"coarse box", gridBox(5)},
                                {"bean", bean},
                                {"lumps", lumps},
                                {"plate", plate}};
  for (const char* name : {"fandisk", "rocker-arm", "homer"})
    for (const NamedMesh& m : model(name)) out.push_back(m);
  return out;
}

struct Found {
  double inside = 0,
         surface = 0;    // errors against the function, at points inside and at the surface
  double triangles = 0;  // against the triangles
};

// Fractions of the target's diagonal.
inline Found measure(const MapFit& fit, const Function& f) {
  Found out;
  const Solid& solid = fit.solid();
  const double unit = fit.boundary.target.diagonal;
  SampleSettings sample;
  sample.seed = 987654;
  std::vector<SurfacePoint> places = randomSamples(solid.surface(), 20000, sample);
  // Beside the vertices.
  for (const SurfacePoint& p : vertexPlaces(solid.surface()))
    for (const double away : {1e-6, 0.02, 0.05, 0.1, 0.2, 0.3}) {
      SurfacePoint q = p;
      for (double& b : q.barycentric) b = (1 - 1.5 * away) * b + 0.5 * away;
      places.push_back(q);
    }
  const Mesh& mesh = solid.surface();
  const Points at = interpolate(mesh.vertices, mesh.triangles, places);
  const Points onTriangles = pointsOf(fit.boundary.targetsOf(places));
  const Points got = pointsOf(fit.map.evaluate(at).values);
  std::vector<double> errors(at.size());
  for (std::size_t i = 0; i < at.size(); ++i) {
    out.triangles = std::max(out.triangles, norm(got[i] - onTriangles[i]) / unit);
    errors[i] = norm(got[i] - f(at[i])) / unit;
    out.surface = std::max(out.surface, errors[i]);
  }
  // Under the surface, where harmonic errors are largest, mostly under the worst of it; and
  // anywhere.
  std::vector<std::size_t> order(at.size());
  std::iota(order.begin(), order.end(), 0);
  std::partial_sort(order.begin(), order.begin() + 500, order.end(),
                    [&](std::size_t a, std::size_t b) { return errors[a] > errors[b]; });
  Points inside;
  const auto under = [&](std::size_t i, double depth) {
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(places[i].triangle)];
    const Vec3 a = mesh.vertices[t[0]];
    const Vec3 normal = cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a);
    const Vec3 p = at[i] - (depth * solid.diagonal() / norm(normal)) * normal;
    if (solid.inside(p)) inside.push_back(p);
  };
  for (std::size_t i = 0; i < 500; ++i)
    for (const double depth : {1e-4, 1e-3}) under(order[i], depth);
  for (std::size_t i = 0; i < 5000; ++i) under(i, 0.005);
  const Vec3 middle = solid.box().center();
  const CounterRandom random(5, 5);
  for (std::size_t i = 0; i < 20000 && inside.size() < 8000; ++i) {
    Vec3 p = middle;
    for (int a = 0; a < 3; ++a) p[a] += (random.uniform(3 * i + a) - 0.5) * solid.diagonal();
    if (solid.inside(p)) inside.push_back(p);
  }
  const Points images = pointsOf(fit.map.evaluate(inside).values);
  for (std::size_t i = 0; i < inside.size(); ++i)
    out.inside = std::max(out.inside, norm(images[i] - f(inside[i])) / unit);
  return out;
}

}  // namespace innermap::known
