#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "innermap/core/error.h"
#include "innermap/fit/mapped_solid.h"
#include "innermap/lattice/cell_mesh.h"
#include "innermap/transfer/inverse_map.h"
#include "lattice/cell_signs.h"
#include "lattice/untangle.h"
#include "transfer/cell_locator.h"

namespace innermap {
namespace {

[[noreturn]] void unfit(const CellMesh& mesh, const std::string& what) {
  throw DataError((mesh.name.empty() ? "mesh" : mesh.name) + ": " + what);
}

Points sourceOf(const CellMesh& mesh) {
  const auto field =
      std::find_if(mesh.vertexFields.begin(), mesh.vertexFields.end(),
                   [](const CellField& f) { return f.name == "source" && f.components == 3; });
  if (field == mesh.vertexFields.end())
    unfit(mesh,
          "its vertices have no field 'source' of the places that they came from; give a .vtu or "
          ".msh file written by remesh");
  Points out(mesh.vertices.size());
  for (std::size_t v = 0; v < out.size(); ++v)
    out[v] = {field->values[3 * v], field->values[3 * v + 1], field->values[3 * v + 2]};
  return out;
}

PointImage sampleOf(const CellLocator& locator, const std::vector<Tetrahedron>& tets,
                    const Points& from, const Points& to, const Vec3& p) {
  PointImage out;
  const CellPoint at = locator.locate(p);
  if (at.tetrahedron < 0) return {p, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, 0};
  out.image = valueAt(to, tets, at);
  const Tetrahedron& t = tets[at.tetrahedron];
  out.jacobian = jacobianOf({to[t[0]], to[t[1]], to[t[2]], to[t[3]]},
                            inverseEdges({from[t[0]], from[t[1]], from[t[2]], from[t[3]]}));
  out.outside = at.distance;
  return out;
}

// Both ends of a carried mesh, which its two ways share.
struct Ends {
  std::vector<Tetrahedron> tets;
  Points source, target;
  CellLocator here, there;

  Ends(const CellMesh& carried, const Points& from)
      : tets(carried.tetrahedra),
        source(from),
        target(carried.vertices),
        here(source, tets),
        there(target, tets) {}
};

bool apart(const Box3& mesh, const Box3& solid) {
  constexpr double kApart = 0.1;  // of the diagonal
  const double most = kApart * solid.diagonal();
  return norm(mesh.lower - solid.lower) > most || norm(mesh.upper - solid.upper) > most;
}

}  // namespace

SolidMap linearMapOf(const CellMesh& carried) {
  validate(carried);
  if (!carried.hexahedra.empty() || carried.tetrahedra.empty())
    unfit(carried, fmt::format("has {} tetrahedra and {} hexahedra; a map is made of tetrahedra",
                               carried.tetrahedra.size(), carried.hexahedra.size()));
  const Points source = sourceOf(carried);
  std::size_t folded = 0, foldedThere = 0;
  for (const Tetrahedron& t : carried.tetrahedra) {
    folded += isInverted(carried.vertices, t);
    foldedThere += isInverted(source, t);
  }
  if (folded + foldedThere > 0)
    unfit(carried, fmt::format("{} of {} tetrahedra are inverted, and {} in their source: as a map "
                               "it would fold; remesh a finer mesh",
                               folded, carried.tetrahedra.size(), foldedThere));
  const auto ends = std::make_shared<const Ends>(carried, source);
  return SolidMap::Pointwise{
      [ends](const Vec3& p) {
        return sampleOf(ends->here, ends->tets, ends->source, ends->target, p);
      },
      [ends](const Vec3& p) {
        return sampleOf(ends->there, ends->tets, ends->target, ends->source, p);
      },
      boundingBox(source).diagonal(), boundingBox(carried.vertices).diagonal()};
}

SolidMap linearMapOf(const CellMesh& carried, const MappedSolid& mapped) {
  if (apart(boundingBox(carried.vertices), boundingBox(mapped.boundary.target.moved)))
    throw DataError(carried.name +
                    ": does not fill the map's target; give the mesh that remesh made with "
                    "this map");
  return linearMapOf(carried);
}

}  // namespace innermap
