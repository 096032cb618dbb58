#include "fit/detail/triangle_error.h"

#include <gtest/gtest.h>

#include "fit/known_maps.h"

namespace innermap {
namespace {

// Of a map with its derivatives.
double errorOf(const Mesh& mesh, const std::function<Vec3(const Vec3&)>& f) {
  return triangleError(mesh, moved(mesh, f).vertices, [&](const Points& at, const Points& normals) {
    std::vector<Vec3> out;
    for (std::size_t i = 0; i < at.size(); ++i)
      out.push_back((f(at[i] + 1e-5 * normals[i]) - f(at[i] - 1e-5 * normals[i])) / 2e-5);
    return out;
  });
}

// In the middles of edges, where that of smooth maps is largest or nearly so.
double trueError(const Mesh& mesh, const std::function<Vec3(const Vec3&)>& f) {
  double most = 0;
  for (const Triangle& t : mesh.triangles)
    for (int e = 0; e < 3; ++e) {
      const Vec3 a = mesh.vertices[t[e]], b = mesh.vertices[t[(e + 1) % 3]];
      most = std::max(most, norm(f(0.5 * (a + b)) - 0.5 * (f(a) + f(b))));
    }
  return most;
}

TEST(TriangleError, IsNoneOfAffineMapsOnBentSurfaces) {
  EXPECT_LT(errorOf(shapes::icosphere(3), affineMap), 1e-9);
  EXPECT_LT(errorOf(shapes::box({0, 0, 0}, {1, 2, 3}), affineMap), 1e-9);
}

TEST(TriangleError, IsAboutThatOfSmoothMaps) {
  for (const Mesh& mesh : {shapes::icosphere(3), shapes::icosphere(4), shapes::torus(60, 30)}) {
    const double found = errorOf(mesh, harmonicPolynomial),
                 known = trueError(mesh, harmonicPolynomial);
    EXPECT_GT(found, 0.9 * known) << mesh.name;
    EXPECT_LT(found, 3 * known) << mesh.name;
  }
}

TEST(TriangleError, FallsWithTheSquareOfTheEdges) {
  EXPECT_NEAR(errorOf(shapes::icosphere(4), harmonicPolynomial) /
                  errorOf(shapes::icosphere(3), harmonicPolynomial),
              0.25, 0.05);
}

// Past a sliver its plane leads anywhere; that is no error on it.
TEST(TriangleError, IsNotLargerForSlivers) {
  Mesh mesh = shapes::icosphere(3);
  const Triangle cut = mesh.triangles[500];
  const Vec3 a = mesh.vertices[cut[0]], b = mesh.vertices[cut[1]], c = mesh.vertices[cut[2]];
  const int beside = static_cast<int>(mesh.vertices.size());
  mesh.vertices.push_back(0.4998 * (a + b) + 0.0004 * c);
  mesh.triangles[500] = {cut[0], cut[1], beside};
  mesh.triangles.push_back({cut[1], cut[2], beside});
  mesh.triangles.push_back({cut[2], cut[0], beside});
  EXPECT_LT(errorOf(mesh, harmonicPolynomial), 4 * trueError(mesh, harmonicPolynomial));
}

// Vertices past the edges of a box tell of it too: the polynomial is harmonic in space.
TEST(TriangleError, IsAboutThatAtSharpEdges) {
  for (const int n : {1, 4}) {
    const Mesh mesh = known::gridBox(n);
    const double found = errorOf(mesh, harmonicPolynomial),
                 known = trueError(mesh, harmonicPolynomial);
    EXPECT_GT(found, 0.7 * known) << n;
    EXPECT_LT(found, 8 * known) << n;
  }
}

TEST(TriangleError, OfNothing) { EXPECT_EQ(errorOf(Mesh(), affineMap), 0); }

}  // namespace
}  // namespace innermap
