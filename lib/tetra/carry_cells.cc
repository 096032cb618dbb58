#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/tetra/cells.h"
#include "tetra/detail/guide_surface.h"
#include "transfer/cell_locator.h"

namespace innermap {
namespace {

constexpr std::size_t kCarryBlock = 1024;
constexpr double kBackwards = -0.25;  // cosine, of normals that cannot belong together

// The boundary's vertices, how they hang together, and which way they face.
struct Boundary {
  std::vector<int> vertices;                 // ascending
  std::vector<int> numberOf;                 // #V, or -1
  std::vector<std::vector<int>> neighbours;  // numbers
  Points normals;                            // of length 1 where there is one

  explicit Boundary(const CellMesh& mesh) : numberOf(mesh.vertices.size(), -1) {
    const std::vector<Triangle> triangles = boundaryTriangles(mesh);
    for (const Triangle& t : triangles) vertices.insert(vertices.end(), t.begin(), t.end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    for (std::size_t b = 0; b < vertices.size(); ++b) numberOf[vertices[b]] = static_cast<int>(b);
    neighbours.resize(vertices.size());
    normals.resize(vertices.size());
    for (const Triangle& t : triangles) {
      const Vec3& a = mesh.vertices[t[0]];
      const Vec3 n = cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a);
      for (int k = 0; k < 3; ++k) {
        const int b = numberOf[t[k]];
        normals[b] += n;
        neighbours[b].push_back(numberOf[t[(k + 1) % 3]]);
      }
    }
    for (Vec3& n : normals)
      if (const double length = norm(n); length > 0) n = n / length;
  }
};

// Closest points that look the other way are sought again along the surface.
std::size_t readdress(const CellMesh& mesh, const Boundary& boundary, const GuideSurface& surface,
                      std::vector<ClosestPoint>& found) {
  const auto agrees = [&](std::size_t b, const ClosestPoint& at) {
    return dot(boundary.normals[b], surface.normal(at.address.triangle)) >= kBackwards;
  };
  std::vector<std::size_t> open;
  for (std::size_t b = 0; b < found.size(); ++b)
    if (!agrees(b, found[b])) open.push_back(b);
  std::size_t changed = 0;
  for (bool progressed = true; progressed && !open.empty();) {
    progressed = false;
    std::vector<std::size_t> left;
    for (const std::size_t b : open) {
      const Vec3& p = mesh.vertices[boundary.vertices[b]];
      ClosestPoint best;
      for (const int n : boundary.neighbours[b]) {
        if (!agrees(static_cast<std::size_t>(n), found[n])) continue;
        const ClosestPoint other = surface.closestFrom(found[n].address.triangle, p);
        if (agrees(b, other) && other.distance < best.distance) best = other;
      }
      if (!std::isfinite(best.distance)) {
        left.push_back(b);
        continue;
      }
      found[b] = best;
      ++changed;
      progressed = true;
    }
    open = std::move(left);
  }
  return changed;
}

void measure(const CellMesh& mesh, const std::vector<ClosestPoint>& found, double diagonal,
             const CarryCellsSettings& settings, CellCarry& out) {
  double squares = 0;
  std::size_t far = 0;
  for (const ClosestPoint& at : found) {
    squares += at.distance * at.distance;
    out.boundaryMax = std::max(out.boundaryMax, at.distance);
    far += !(at.distance <= settings.farthest * diagonal);
  }
  out.boundaryVertices = found.size();
  out.boundaryRms =
      std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, found.size())));
  if (far > 0)
    throw DataError(fmt::format(
        "{}: {} of {} vertices of the boundary are not on the map's solid, the farthest {:.3g} "
        "from its surface, {:.3g} of its diagonal: the mesh must fill the solid, without hanging "
        "nodes, in the same place and units; carry other geometry with push",
        mesh.name.empty() ? "mesh" : mesh.name, far, found.size(), out.boundaryMax,
        out.boundaryMax / diagonal));
}

// Vertices that cells use and the boundary does not.
std::vector<int> verticesInside(const CellMesh& mesh, const Boundary& boundary) {
  std::vector<char> used(mesh.vertices.size(), 0);
  for (const Tetrahedron& t : mesh.tetrahedra)
    for (const int v : t) used[v] = 1;
  for (const Hexahedron& h : mesh.hexahedra)
    for (const int v : h) used[v] = 1;
  std::vector<int> inside;
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v] && boundary.numberOf[v] < 0) inside.push_back(static_cast<int>(v));
  return inside;
}

// A surface whose triangles have places on another: those of `address`, at `to`.
struct BoundaryWay {
  const Mesh& from;
  std::function<SurfacePoint(const SurfacePoint&)> address;
  const Mesh& to;
  double diagonal;  // of `from`
};

CellCarry carry(const CellMesh& mesh, const BoundaryWay& way, const CarryCellsSettings& settings,
                const std::function<Points(const Points&)>& inner) {
  requireNumber("farthest", settings.farthest, {0, 1, true});
  validate(mesh);
  if (mesh.tetrahedra.empty() && mesh.hexahedra.empty())
    throw DataError((mesh.name.empty() ? "mesh" : mesh.name) + ": has no cells");
  const Boundary boundary(mesh);
  const GuideSurface surface(way.from.vertices, way.from.triangles);
  std::vector<ClosestPoint> found(boundary.vertices.size());
  parallelBlocks(
      found.size(), kCarryBlock,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b)
          found[b] = surface.closest(mesh.vertices[boundary.vertices[b]]);
      },
      "placing the boundary");
  CellCarry out;
  measure(mesh, found, way.diagonal, settings, out);
  out.readdressed = readdress(mesh, boundary, surface, found);
  // Vertices that no cell uses stay.
  out.cells.positions = mesh.vertices;
  out.cells.onSurface.assign(mesh.vertices.size(), {-1, {1, 0, 0}});
  std::vector<SurfacePoint> places;
  for (const ClosestPoint& at : found) places.push_back(way.address(at.address));
  const Points to = interpolate(way.to.vertices, way.to.triangles, places);
  for (std::size_t b = 0; b < places.size(); ++b) {
    out.cells.positions[boundary.vertices[b]] = to[b];
    out.cells.onSurface[boundary.vertices[b]] = places[b];
  }
  const std::vector<int> inside = verticesInside(mesh, boundary);
  Points from;
  for (const int v : inside) from.push_back(mesh.vertices[v]);
  const Points images = inner(from);
  for (std::size_t i = 0; i < inside.size(); ++i) out.cells.positions[inside[i]] = images[i];
  return out;
}

}  // namespace

Mesh sourceSurface(const MappedSolid& mapped) { return mapped.solid().repaired().mesh; }

Mesh targetSurface(const MappedSolid& mapped) {
  return mapped.boundary.target.mesh(mapped.solid(), "target");
}

CellCarry carryCells(const CellMesh& mesh, const MappedSolid& mapped,
                     const CarryCellsSettings& settings) {
  const Solid& solid = mapped.solid();
  const Mesh target = targetSurface(mapped);
  const BoundaryWay way{solid.surface(), [&](const SurfacePoint& p) { return solid.address(p); },
                        target, solid.diagonal()};
  return carry(mesh, way, settings, [&](const Points& from) {
    if (from.empty()) return Points{};
    EvaluateFieldSettings evaluating;
    evaluating.accuracy = sumAccuracy(mapped) * mapped.boundary.target.diagonal;
    return pointsOf(mapped.map.evaluate(from, evaluating).values);
  });
}

CellCarry carryCellsBack(const CellMesh& mesh, const MappedSolid& mapped, const CellMap& map,
                         const CarryCellsSettings& settings) {
  const Mesh target = targetSurface(mapped);
  const BoundaryWay way{target, [](const SurfacePoint& p) { return p; },
                        mapped.solid().repaired().mesh, mapped.boundary.target.diagonal};
  const CellLocator locator(*map.carried, map.mesh->tetrahedra);
  return carry(mesh, way, settings, [&](const Points& from) {
    Points to(from.size());
    parallelBlocks(
        from.size(), kCarryBlock,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            const CellPoint at = locator.locate(from[i]);
            to[i] = at.tetrahedron < 0
                        ? from[i]
                        : valueAt(map.mesh->vertices, map.mesh->tetrahedra, clamped(at));
          }
        },
        "locating vertices");
    return to;
  });
}

}  // namespace innermap
