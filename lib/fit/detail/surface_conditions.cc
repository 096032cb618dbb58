#include "fit/detail/surface_conditions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/pi.h"
#include "fit/detail/problem_samples.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {

SurfaceConditions::SurfaceConditions(const SourceBoundary& boundary,
                                     const BoundaryConditions& conditions)
    : boundary_(boundary), conditions_(conditions) {
  channels_ = conditions.function ? 0 : conditions.values.columns();
  check();
  splitSurface();
  if (anyFree()) smoothNormals();
  averageCorners();
  if (conditions.function) {
    const Mesh& surface = boundary.solid.surface();
    channels_ = conditions.function({positionOf(surface, SurfacePoint{})}).columns();
  }
  if (channels_ == 0) throw DataError("harmonic field: there is no channel of values");
  if (conditions.flux.rows() > 0 && conditions.flux.columns() != channels_)
    throw DataError(fmt::format("harmonic field: fluxes have {} channels, values {}",
                                conditions.flux.columns(), channels_));
}

void SurfaceConditions::check() const {
  const Mesh& mesh = boundary_.mesh;
  const std::size_t triangles = mesh.triangles.size(), rows = conditions_.values.rows();
  double angle = conditions_.creaseAngle;
  requireInRange({creaseSetting(&angle)});
  if (!conditions_.function && rows != mesh.vertices.size() && rows != 3 * triangles)
    throw DataError(fmt::format(
        "harmonic field: {} rows of values for {} vertices; there must be one a vertex, or three a "
        "triangle",
        rows, mesh.vertices.size()));
  if (!conditions_.free.empty() && conditions_.free.size() != triangles)
    throw DataError(fmt::format("harmonic field: {} marks of fluxes for {} triangles",
                                conditions_.free.size(), triangles));
  if (conditions_.flux.rows() > 0 && conditions_.flux.rows() != triangles)
    throw DataError(fmt::format("harmonic field: {} rows of fluxes for {} triangles",
                                conditions_.flux.rows(), triangles));
  for (std::size_t t = 0; t < triangles; ++t) {
    const bool isFlux = !conditions_.free.empty() && conditions_.free[t] != 0;
    for (std::size_t k = 0; k < conditions_.flux.columns() && isFlux; ++k)
      if (!std::isfinite(conditions_.flux(t, k)))
        throw DataError(fmt::format("harmonic field: the flux of triangle {} is not finite", t));
    for (std::size_t c = 0; c < 3 && !isFlux && !conditions_.function; ++c) {
      const auto v = static_cast<std::size_t>(mesh.triangles[t][c]);
      for (std::size_t k = 0; k < conditions_.values.columns(); ++k)
        if (!std::isfinite(conditions_.values(rows == 3 * triangles ? 3 * t + c : v, k)))
          throw DataError(fmt::format(
              "harmonic field: the value at vertex {} of triangle {} is not finite", v, t));
    }
  }
}

void SurfaceConditions::splitSurface() {
  const Mesh& surface = boundary_.solid.surface();
  const bool any = std::any_of(conditions_.free.begin(), conditions_.free.end(),
                               [](std::uint8_t f) { return f != 0; });
  freePieces_.assign(surface.triangles.size(), 0);
  if (!any) return;
  Mesh fixed;
  double freeArea = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const int input = inputTriangle({static_cast<int>(t), {1.0 / 3, 1.0 / 3, 1.0 / 3}});
    freePieces_[t] = input < 0 || conditions_.free[static_cast<std::size_t>(input)] != 0;
    if (freePieces_[t])
      freeArea += norm(areaVector(surface, static_cast<int>(t)));
    else
      fixed.triangles.push_back(surface.triangles[t]);
  }
  if (fixed.triangles.empty())
    throw DataError(
        "harmonic field: the flux is given everywhere, which leaves a constant open; give a value "
        "somewhere");
  freeShare_ = freeArea / surfaceArea(surface);
  fixed_ = std::make_unique<TriangleTree>(surface.vertices, fixed.triangles);
}

void SurfaceConditions::smoothNormals() {
  const Mesh& surface = boundary_.solid.surface();
  const std::size_t count = surface.triangles.size();
  Points normals(count);  // unit, 0 where a triangle has no area
  std::vector<std::vector<std::pair<std::size_t, Vec3>>> around(surface.vertices.size());
  for (std::size_t t = 0; t < count; ++t) {
    const Triangle& corners = surface.triangles[t];
    const Vec3 normal = areaVector(surface, static_cast<int>(t));
    const double area = norm(normal);
    if (!(area > 0)) continue;
    normals[t] = normal / area;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto at = [&](std::size_t k) {
        return surface.vertices[static_cast<std::size_t>(corners[(c + k) % 3])];
      };
      const Vec3 a = at(1) - at(0), b = at(2) - at(0);
      around[static_cast<std::size_t>(corners[c])].emplace_back(
          t, cross(a, b) / (dot(a, a) * dot(b, b)));
    }
  }
  const double least = std::cos(conditions_.creaseAngle * kPi / 180);
  normals_.resize(count);
  parallelBlocks(count, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      for (std::size_t c = 0; c < 3; ++c) {
        Vec3 sum;
        for (const auto& [other, weighted] :
             around[static_cast<std::size_t>(surface.triangles[t][c])])
          if (other == t || dot(normals[other], normals[t]) > least) sum += weighted;
        const double length = norm(sum);
        normals_[t][c] = length > 0 ? sum / length : normals[t];
      }
  });
}

void SurfaceConditions::averageCorners() {
  const Mesh& mesh = boundary_.mesh;
  if (conditions_.function || conditions_.values.rows() == mesh.vertices.size()) return;
  ofVertices_ = Matrix(mesh.vertices.size(), channels_);
  std::vector<double> count(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t c = 0; c < 3 && (conditions_.free.empty() || !conditions_.free[t]); ++c) {
      const auto v = static_cast<std::size_t>(mesh.triangles[t][c]);
      ++count[v];
      for (std::size_t k = 0; k < channels_; ++k)
        ofVertices_(v, k) += (conditions_.values(3 * t + c, k) - ofVertices_(v, k)) / count[v];
    }
}

Vec3 SurfaceConditions::normalAt(const SurfacePoint& onSurface) const {
  const std::array<Vec3, 3>& corners = normals_[static_cast<std::size_t>(onSurface.triangle)];
  Vec3 sum;
  for (std::size_t c = 0; c < 3; ++c) sum += onSurface.barycentric[c] * corners[c];
  const double length = norm(sum);
  return length > 0 ? sum / length : Vec3{};
}

int SurfaceConditions::inputTriangle(const SurfacePoint& onSurface) const {
  const SurfacePoint address = boundary_.solid.address(onSurface);
  return boundary_.solid.repaired().parent[static_cast<std::size_t>(address.triangle)];
}

bool SurfaceConditions::isFree(const SurfacePoint& onSurface) const {
  return freePieces_[static_cast<std::size_t>(onSurface.triangle)] != 0;
}

// A vertex of the repaired mesh, as the triangle of the input has it.
double SurfaceConditions::corner(int repairedVertex, int inputTriangle, std::size_t channel) const {
  const Mesh& mesh = boundary_.mesh;
  if (conditions_.values.rows() == mesh.vertices.size())
    return conditions_.values(static_cast<std::size_t>(repairedVertex), channel);
  if (inputTriangle < 0) return ofVertices_(static_cast<std::size_t>(repairedVertex), channel);
  const Triangle& corners = mesh.triangles[static_cast<std::size_t>(inputTriangle)];
  const auto c = std::find(corners.begin(), corners.end(), repairedVertex) - corners.begin();
  return conditions_.values(
      static_cast<std::size_t>(3 * inputTriangle + std::min<std::ptrdiff_t>(c, 2)), channel);
}

double SurfaceConditions::value(const SurfacePoint& address, std::size_t channel) const {
  const RepairedMesh& repaired = boundary_.solid.repaired();
  const int input = repaired.parent[static_cast<std::size_t>(address.triangle)];
  const auto known = static_cast<int>(boundary_.mesh.vertices.size());
  const Triangle& corners = repaired.mesh.triangles[static_cast<std::size_t>(address.triangle)];
  double out = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    if (address.barycentric[c] == 0) continue;
    double at = 0;
    if (corners[c] < known)
      at = corner(corners[c], input, channel);
    else
      for (const auto& [vertex, weight] :
           repaired.capVertices[static_cast<std::size_t>(corners[c] - known)].weights)
        at += weight * corner(vertex, input, channel);
    out += address.barycentric[c] * at;
  }
  return out;
}

void SurfaceConditions::checkFunction(const Matrix& out, std::size_t points) const {
  if (out.rows() != points || out.columns() != channels_)
    throw DataError(fmt::format("harmonic field: a function gave {} x {} numbers for {} points",
                                out.rows(), out.columns(), points));
  for (std::size_t i = 0; i < out.rows() * out.columns(); ++i)
    if (!std::isfinite(out.data()[i]))
      throw DataError("harmonic field: a function gave a number that is not finite");
}

Matrix SurfaceConditions::values(const std::vector<SurfacePoint>& onSurface) const {
  if (onSurface.empty()) return {0, channels_};
  if (conditions_.function) {
    Matrix out = conditions_.function(positionsOf(boundary_.solid, onSurface));
    checkFunction(out, onSurface.size());
    return out;
  }
  Matrix out(onSurface.size(), channels_);
  for (std::size_t i = 0; i < onSurface.size(); ++i) {
    const SurfacePoint address = boundary_.solid.address(onSurface[i]);
    for (std::size_t k = 0; k < channels_; ++k) out(i, k) = value(address, k);
  }
  return out;
}

Matrix SurfaceConditions::valuesAt(const std::vector<SurfacePoint>& addresses) const {
  Matrix out(addresses.size(), channels_);
  for (std::size_t i = 0; i < addresses.size(); ++i) {
    const int input =
        boundary_.solid.repaired().parent[static_cast<std::size_t>(addresses[i].triangle)];
    const bool free = anyFree() && (input < 0 || conditions_.free[static_cast<std::size_t>(input)]);
    for (std::size_t k = 0; k < channels_; ++k)
      out(i, k) = free ? std::numeric_limits<double>::quiet_NaN() : value(addresses[i], k);
  }
  return out;
}

Matrix SurfaceConditions::fluxes(const std::vector<SurfacePoint>& onSurface,
                                 const Points& normals) const {
  if (onSurface.empty()) return {0, channels_};
  if (conditions_.fluxFunction) {
    Matrix out = conditions_.fluxFunction(positionsOf(boundary_.solid, onSurface), normals);
    checkFunction(out, onSurface.size());
    return out;
  }
  Matrix out(onSurface.size(), channels_);
  if (conditions_.flux.rows() == 0) return out;
  for (std::size_t i = 0; i < onSurface.size(); ++i) {
    const int input = inputTriangle(onSurface[i]);
    for (std::size_t k = 0; k < channels_ && input >= 0; ++k)
      out(i, k) = conditions_.flux(static_cast<std::size_t>(input), k);
  }
  return out;
}

Matrix SurfaceConditions::rows(const std::vector<SurfacePoint>& onSurface) const {
  if (!anyFree()) return values(onSurface);
  const Points along = directions(onSurface);
  std::vector<std::size_t> here[2];  // indices where values, where fluxes are given
  std::vector<SurfacePoint> places[2];
  Points normals;
  for (std::size_t i = 0; i < onSurface.size(); ++i) {
    const double length = norm(along[i]);
    here[length > 0].push_back(i);
    places[length > 0].push_back(onSurface[i]);
    if (length > 0) normals.push_back(along[i] / length);
  }
  const Matrix given[2] = {values(places[0]), fluxes(places[1], normals)};
  Matrix out(onSurface.size(), channels_);
  for (int kind = 0; kind < 2; ++kind)
    for (std::size_t k = 0; k < channels_; ++k)
      for (std::size_t i = 0; i < here[kind].size(); ++i)
        out(here[kind][i], k) = given[kind](i, k) * (kind == 0 ? 1 : norm(along[here[kind][i]]));
  return out;
}

Points SurfaceConditions::directions(const std::vector<SurfacePoint>& onSurface) const {
  if (!anyFree()) return {};
  const Mesh& surface = boundary_.solid.surface();
  Points out(onSurface.size());
  parallelBlocks(onSurface.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!isFree(onSurface[i])) continue;
      const double away = fixed_->closest(positionOf(surface, onSurface[i])).distance;
      out[i] = std::max(away, kLeastLength * boundary_.solid.diagonal()) * normalAt(onSurface[i]);
    }
  });
  return out;
}

}  // namespace innermap
