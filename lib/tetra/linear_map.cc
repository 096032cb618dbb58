#include <fmt/format.h>

#include <algorithm>

#include "innermap/core/error.h"
#include "innermap/tetra/cells.h"
#include "lattice/cell_signs.h"
#include "lattice/untangle.h"

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

LinearSample sampleOf(const CellLocator& locator, const std::vector<Tetrahedron>& tets,
                      const Points& from, const Points& to, const Vec3& p) {
  LinearSample out;
  const CellPoint at = locator.locate(p);
  if (at.tetrahedron < 0) return {p, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, 0};
  out.image = valueAt(to, tets, at);
  const Tetrahedron& t = tets[at.tetrahedron];
  out.jacobian = jacobianOf({to[t[0]], to[t[1]], to[t[2]], to[t[3]]},
                            inverseEdges({from[t[0]], from[t[1]], from[t[2]], from[t[3]]}));
  out.outside = at.distance;
  return out;
}

}  // namespace

struct LinearCellMap::Data {
  std::vector<Tetrahedron> tets;
  Points source, target;
  CellLocator there, back;

  explicit Data(const CellMesh& mesh)
      : tets(mesh.tetrahedra),
        source(sourceOf(mesh)),
        target(mesh.vertices),
        there(source, tets),
        back(target, tets) {}
};

LinearCellMap::LinearCellMap(const CellMesh& carried) {
  validate(carried);
  if (!carried.hexahedra.empty() || carried.tetrahedra.empty())
    unfit(carried, fmt::format("has {} tetrahedra and {} hexahedra; a map is made of tetrahedra",
                               carried.tetrahedra.size(), carried.hexahedra.size()));
  const Points source = sourceOf(carried);
  std::size_t here = 0, there = 0;
  for (const Tetrahedron& t : carried.tetrahedra) {
    here += isInverted(carried.vertices, t);
    there += isInverted(source, t);
  }
  if (here + there > 0)
    unfit(carried, fmt::format("{} of {} tetrahedra are inverted, and {} in their source: as a map "
                               "it would fold; remesh a finer mesh",
                               here, carried.tetrahedra.size(), there));
  data_ = std::make_shared<Data>(carried);
  sourceDiagonal_ = boundingBox(data_->source).diagonal();
  targetDiagonal_ = boundingBox(data_->target).diagonal();
}

LinearSample LinearCellMap::push(const Vec3& p) const {
  return sampleOf(data_->there, data_->tets, data_->source, data_->target, p);
}

LinearSample LinearCellMap::pull(const Vec3& q) const {
  return sampleOf(data_->back, data_->tets, data_->target, data_->source, q);
}

}  // namespace innermap
