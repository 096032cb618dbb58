#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <vector>

#include "innermap/core/error.h"
#include "innermap/fit/fit_harmonic.h"

namespace innermap {
namespace {

constexpr double kRounding = 1e-12;

double cornerAngle(const Mesh& mesh, const Triangle& corners, std::size_t c) {
  const auto at = [&](std::size_t k) {
    return mesh.vertices[static_cast<std::size_t>(corners[(c + k) % 3])];
  };
  const Vec3 a = at(1) - at(0), b = at(2) - at(0);
  return std::atan2(norm(cross(a, b)), dot(a, b));
}

// The first vertex at the place of each: parts of a surface often have their border twice.
std::vector<std::size_t> firstAtPlace(const Points& vertices) {
  std::vector<std::size_t> order(vertices.size()), out(vertices.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  const auto key = [&](std::size_t v) {
    return std::make_tuple(vertices[v].x, vertices[v].y, vertices[v].z);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    out[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? out[order[i - 1]] : order[i];
  return out;
}

void requireTriangles(const Mesh& mesh, const SurfaceGroup& group) {
  if (group.triangles.empty())
    throw DataError(fmt::format(
        "group '{}' has no faces; a point or a line inside cannot hold a value in three "
        "dimensions: give it as a small ball or tube, a closed part of the surface",
        group.name));
  for (const int t : group.triangles)
    if (t < 0 || static_cast<std::size_t>(t) >= mesh.triangles.size())
      throw DataError(fmt::format("group '{}' has triangle {} of {} (counted from 0)", group.name,
                                  t, mesh.triangles.size()));
}

bool sameRow(const Matrix& m, std::size_t a, std::size_t b) {
  for (std::size_t k = 0; k < m.columns(); ++k)
    if (m(a, k) < m(b, k) || m(a, k) > m(b, k)) return false;
  return true;
}

}  // namespace

BoundaryConditions valuesAtVertices(const Mesh& mesh, Matrix values) {
  if (values.rows() != mesh.vertices.size())
    throw DataError(fmt::format("{}: {} rows of values for {} vertices", mesh.name, values.rows(),
                                mesh.vertices.size()));
  BoundaryConditions out;
  out.free.assign(mesh.triangles.size(), 0);
  for (std::size_t t = 0; t < out.free.size(); ++t)
    for (const int v : mesh.triangles[t])
      for (std::size_t k = 0; k < values.columns(); ++k)
        if (!std::isfinite(values(static_cast<std::size_t>(v), k))) out.free[t] = 1;
  out.values = std::move(values);
  return out;
}

BoundaryConditions valuesOnGroups(const Mesh& mesh, const std::vector<SurfaceGroup>& groups,
                                  const Matrix& values) {
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  if (values.rows() != groups.size() || values.columns() == 0)
    throw DataError(fmt::format("{} rows of values for {} groups", values.rows(), groups.size()));
  BoundaryConditions out;
  out.values = Matrix(3 * mesh.triangles.size(), values.columns());
  out.free.assign(mesh.triangles.size(), 1);
  std::vector<std::size_t> group(mesh.triangles.size(), kNone);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    requireTriangles(mesh, groups[g]);
    for (const int triangle : groups[g].triangles) {
      const auto t = static_cast<std::size_t>(triangle);
      if (group[t] != kNone && !sameRow(values, g, group[t]))
        throw DataError(
            fmt::format("{}: triangle {} is in group '{}' and in group '{}', which have "
                        "other values; name groups that share none",
                        mesh.name, t, groups[group[t]].name, groups[g].name));
      group[t] = g;
      out.free[t] = 0;
      for (std::size_t k = 0; k < values.columns(); ++k)
        for (std::size_t c = 0; c < 3; ++c) out.values(3 * t + c, k) = values(g, k);
    }
  }
  return out;
}

void setFluxes(const Mesh& mesh, const std::vector<SurfaceGroup>& groups, const Matrix& flux,
               BoundaryConditions& conditions) {
  if (flux.rows() != groups.size())
    throw DataError(fmt::format("{} rows of fluxes for {} groups", flux.rows(), groups.size()));
  if (conditions.flux.empty()) conditions.flux = Matrix(mesh.triangles.size(), flux.columns());
  if (conditions.free.empty()) conditions.free.assign(mesh.triangles.size(), 0);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    requireTriangles(mesh, groups[g]);
    for (const int triangle : groups[g].triangles) {
      const auto t = static_cast<std::size_t>(triangle);
      conditions.free[t] = 1;
      for (std::size_t k = 0; k < flux.columns(); ++k) conditions.flux(t, k) = flux(g, k);
    }
  }
}

BoundaryConditions weightConditions(const Mesh& mesh, const std::vector<SurfaceGroup>& groups) {
  if (groups.size() < 2)
    throw DataError(fmt::format("{}: weights need two groups of faces or more, here {}", mesh.name,
                                groups.size() == 1 ? "is one" : "are none"));
  Matrix values(groups.size(), groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) values(g, g) = 1;
  BoundaryConditions out = valuesOnGroups(mesh, groups, values);
  out.unitSum = true;
  return out;
}

std::string joinedText(double share) {
  return share > 0 ? fmt::format(
                         "values that touch are joined: on {:.2g}% of the surface, the triangles "
                         "along their borders, they blend",
                         100 * share)
                   : "";
}

double removeJumps(const Mesh& mesh, BoundaryConditions& conditions) {
  const std::size_t triangles = mesh.triangles.size(), channels = conditions.values.columns();
  const std::size_t rows = conditions.values.rows();
  const bool atCorners = !conditions.function && rows == 3 * triangles;
  if ((!atCorners && !conditions.function && rows != mesh.vertices.size()) ||
      (!conditions.free.empty() && conditions.free.size() != triangles))
    throw DataError("removeJumps: values or free triangles are not those of the mesh");
  if (!atCorners) return 0;
  const Matrix corners = std::move(conditions.values);
  const auto held = [&](std::size_t t) { return conditions.free.empty() || !conditions.free[t]; };
  const std::vector<std::size_t> first = firstAtPlace(mesh.vertices);
  const auto vertexOf = [&](std::size_t t, std::size_t c) {
    return first[static_cast<std::size_t>(mesh.triangles[t][c])];
  };
  Matrix mean(mesh.vertices.size(), channels);
  std::vector<double> angles(mesh.vertices.size(), 0);
  for (std::size_t t = 0; t < triangles; ++t)
    for (std::size_t c = 0; c < 3 && held(t); ++c) {
      const std::size_t v = vertexOf(t, c);
      const double angle = cornerAngle(mesh, mesh.triangles[t], c);
      angles[v] += angle;
      for (std::size_t k = 0; k < channels; ++k) mean(v, k) += angle * corners(3 * t + c, k);
    }
  for (std::size_t v = 0; v < angles.size(); ++v)
    for (std::size_t k = 0; k < channels; ++k)
      mean(v, k) = first[v] < v ? mean(first[v], k) : angles[v] > 0 ? mean(v, k) / angles[v] : 0;
  const auto* const end = corners.data() + corners.rows() * channels;
  double scale = 0;
  for (const auto* value = corners.data(); value != end; ++value)
    scale = std::max(scale, std::abs(*value));
  double changed = 0;
  for (std::size_t t = 0; t < triangles; ++t) {
    double most = 0;
    for (std::size_t c = 0; c < 3 && held(t); ++c)
      for (std::size_t k = 0; k < channels; ++k)
        most = std::max(most, std::abs(corners(3 * t + c, k) - mean(vertexOf(t, c), k)));
    if (most > kRounding * scale) changed += norm(areaVector(mesh, static_cast<int>(t)));
  }
  conditions.values = std::move(mean);
  return changed / surfaceArea(mesh);
}

Setting creaseSetting(double* angle) {
  return Setting("crease_angle", "DEGREES", angle,
                 "triangles that meet at a smaller angle count as smooth, and flux goes along "
                 "interpolated normals; 0: along each triangle's own")
      .from(0, 90)
      .rare();
}

}  // namespace innermap
