#include "fit/detail/triangle_error.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "innermap/core/run.h"

namespace innermap {
namespace {

// Of a harmonic polynomial of second order in space, less what is known: products of two
// barycentric coordinates, which vanish at the corners, each with the square of the distance from
// the plane that makes it harmonic; and twists about two directions in the plane.
constexpr int kTerms = 3;
using Terms = Eigen::Matrix<double, kTerms, 1>;

// Of these terms, per square of a distance in sizes: of regular triangles.
constexpr double kLikeDistance = 0.44;
constexpr double kRidge = 1e-3;  // keeps the polynomial small where vertices do not tell it

// Of what the polynomial leaves of the misses: what a third order does on the triangle, and what
// may be between vertices that do not resolve the map, where the polynomial leaves most of them.
// Measured at charges near to balls and tori, down to half an edge: see the test of known
// functions.
constexpr double kThirdOrder = 1.0 / 8, kUnresolved = 6, kMost = 2;

class Triangles {
 public:
  Triangles(const Mesh& mesh, const Points& values)
      : mesh_(mesh), values_(values), first_(mesh.vertices.size() + 1, 0) {
    for (const Triangle& t : mesh.triangles)
      for (const int v : t) ++first_[static_cast<std::size_t>(v) + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    of_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (const int v : mesh.triangles[t]) of_[next[static_cast<std::size_t>(v)]++] = t;
  }

  Vec3 corner(std::size_t t, int c) const { return mesh_.vertices[vertex(t, c)]; }
  Vec3 centroid(std::size_t t) const {
    return (1.0 / 3) * (corner(t, 0) + corner(t, 1) + corner(t, 2));
  }
  Vec3 areaVector(std::size_t t) const {
    return cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
  }

  // slope: along the unit normal.
  double miss(std::size_t t, const Vec3& slope) const;

 private:
  std::size_t vertex(std::size_t t, int c) const {
    return static_cast<std::size_t>(mesh_.triangles[t][static_cast<std::size_t>(c)]);
  }
  std::vector<std::size_t> around(std::size_t t) const;

  const Mesh& mesh_;
  const Points& values_;
  std::vector<std::size_t> first_, of_;  // triangles of each vertex
};

std::vector<std::size_t> Triangles::around(std::size_t t) const {
  std::vector<std::size_t> out;
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = first_[vertex(t, c)]; i < first_[vertex(t, c) + 1]; ++i)
      for (int d = 0; d < 3; ++d) out.push_back(vertex(of_[i], d));
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  const auto isCorner = [&](std::size_t v) {
    return v == vertex(t, 0) || v == vertex(t, 1) || v == vertex(t, 2);
  };
  out.erase(std::remove_if(out.begin(), out.end(), isCorner), out.end());
  return out;
}

double Triangles::miss(std::size_t t, const Vec3& slope) const {
  const Vec3 normal2 = areaVector(t);
  const double area2 = norm(normal2);
  if (!(area2 > 0)) return 0;
  const Vec3 normal = normal2 / area2, a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
  const double size2 = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
  // Gradients of the barycentric coordinates.
  const Vec3 g1 = cross(normal, c - b) / area2, g2 = cross(normal, a - c) / area2,
             g3 = -1.0 * (g1 + g2);
  struct Miss {
    Terms terms;
    Eigen::Vector3d value;
    double weight;
  };
  Eigen::Matrix<double, kTerms, kTerms> normalMatrix =
      Eigen::Matrix<double, kTerms, kTerms>::Zero();
  Eigen::Matrix<double, kTerms, 3> right = Eigen::Matrix<double, kTerms, 3>::Zero();
  std::vector<Miss> misses;
  for (const std::size_t v : around(t)) {
    const Vec3 p = mesh_.vertices[v], from = p - centroid(t);
    const double off = dot(p - a, normal), distance2 = dot(from, from);
    const double l1 = dot(p - b, g1), l2 = dot(p - c, g2), l3 = 1 - l1 - l2;
    const Vec3 miss = values_[v] - l1 * values_[vertex(t, 0)] - l2 * values_[vertex(t, 1)] -
                      l3 * values_[vertex(t, 2)] - off * slope;
    Miss m;
    m.terms << l1 * l2 - off * off * dot(g1, g2), l2 * l3 - off * off * dot(g2, g3),
        l3 * l1 - off * off * dot(g3, g1);
    m.value = {miss.x, miss.y, miss.z};
    // Past a sliver the plane is far off, and the polynomial as much larger than on it.
    m.weight = std::min(size2 / (size2 + distance2), 1 / (1 + kLikeDistance * m.terms.lpNorm<1>()));
    normalMatrix += m.weight * m.weight * m.terms * m.terms.transpose();
    right += m.weight * m.weight * m.terms * m.value.transpose();
    misses.push_back(m);
  }
  if (misses.empty()) return 0;
  normalMatrix.diagonal().array() += kRidge * normalMatrix.trace() / kTerms;
  const Eigen::Matrix<double, kTerms, 3> q = normalMatrix.ldlt().solve(right);
  // In the middle of the edges, and of the triangle.
  double most = q.colwise().sum().norm() / 9;
  for (int e = 0; e < 3; ++e) most = std::max(most, q.row(e).norm() / 4);
  double left = 0, largest = 0;
  for (const Miss& m : misses) {
    left = std::max(left, m.weight * (m.value - q.transpose() * m.terms).norm());
    largest = std::max(largest, m.weight * m.value.norm());
  }
  if (!(largest > 0)) return 0;
  const double unresolved = left / largest;
  return most + std::min(kThirdOrder + kUnresolved * std::pow(unresolved, 4), kMost) * left;
}

// The affine map nearest to the values; what it leaves.
Points lessAffine(const Mesh& mesh, const Points& values) {
  Vec3 center, middle;
  const double n = static_cast<double>(values.size());
  for (std::size_t v = 0; v < values.size(); ++v) {
    center = center + mesh.vertices[v] / n;
    middle = middle + values[v] / n;
  }
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero(), mixed = Eigen::Matrix3d::Zero();
  const auto eigen = [](const Vec3& p) { return Eigen::Vector3d(p.x, p.y, p.z); };
  for (std::size_t v = 0; v < values.size(); ++v) {
    const Eigen::Vector3d p = eigen(mesh.vertices[v] - center);
    moments += p * p.transpose();
    mixed += eigen(values[v] - middle) * p.transpose();
  }
  const Eigen::Matrix3d linear =
      moments.completeOrthogonalDecomposition().solve(mixed.transpose()).transpose();
  Points out(values.size());
  for (std::size_t v = 0; v < values.size(); ++v) {
    const Eigen::Vector3d image = linear * eigen(mesh.vertices[v] - center);
    out[v] = values[v] - middle - Vec3{image[0], image[1], image[2]};
  }
  return out;
}

}  // namespace

double triangleError(const Mesh& mesh, const Points& values, const NormalDerivatives& derivatives,
                     const TriangleErrorSettings& settings) {
  std::vector<std::size_t> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  if (order.size() > settings.triangles) {
    const Points rest = lessAffine(mesh, values);
    const Triangles coarse(mesh, rest);
    std::vector<double> misses(order.size());
    parallelBlocks(order.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) misses[t] = coarse.miss(t, {});
    });
    std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(settings.triangles),
                     order.end(), [&](std::size_t a, std::size_t b) {
                       return misses[a] != misses[b] ? misses[a] > misses[b] : a < b;
                     });
    order.resize(settings.triangles);
  }
  const Triangles triangles(mesh, values);
  Points at, normals;
  for (const std::size_t t : order) {
    const Vec3 area = triangles.areaVector(t);
    const double size = norm(area);
    at.push_back(triangles.centroid(t));
    normals.push_back(size > 0 ? area / size : Vec3{0, 0, 1});
  }
  const std::vector<Vec3> slopes = derivatives(at, normals);
  std::vector<double> misses(order.size());
  parallelBlocks(order.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) misses[i] = triangles.miss(order[i], slopes[i]);
  });
  return misses.empty() ? 0 : *std::max_element(misses.begin(), misses.end());
}

}  // namespace innermap
