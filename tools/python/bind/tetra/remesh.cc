// Cells carried by a map and repaired; finite elements beside charges.
#include "bind/cells.h"
#include "bind/errors.h"
#include "bind/figures.h"
#include "bind/keywords.h"
#include "bind/lists.h"
#include "bind/map.h"
#include "bind/meshes.h"
#include "innermap/tetra/compare_fem.h"
#include "innermap/tetra/remesh_cells.h"
#include "jobs/tetra/cell_needs.h"
#include "report/figures.h"

namespace py = pybind11;
using namespace py::literals;

namespace innermap::python {
namespace {

struct RemeshOptions {
  RemeshSettings settings;
  py::object surface, vectors, normals;
  CallOptions call;

  void describe(Keywords& k) {
    k.object("surface", &surface, "mesh",
             "that the boundary goes onto, the solid's own but for how it is cut into triangles; "
             "if not given that of the map");
    k.settings(innermap::describe(settings));
    k.object("vectors", &vectors, "list[str]",
             "fields that are vectors, turned by the Jacobian, beside those that a file says are");
    k.object(
        "normals", &normals, "list[str]",
        "fields that are normals of surfaces, turned by the inverse transpose of the Jacobian");
    call.describe(k);
    call.describeTime(k);
  }
};

py::object remesh(const Arguments& a, RemeshOptions& o) {
  if (!py::isinstance<PyMap>(a[0])) wrongType("map", "expects an innermap.Map");
  const auto& map = py::cast<const PyMap&>(a[0]);
  CellMesh cells = cellsFrom(a[1], "cells", o.call, textsFrom(o.vectors, "vectors"),
                             textsFrom(o.normals, "normals"));
  std::optional<Mesh> surface;
  if (!o.surface.is_none()) surface = meshFrom(o.surface, "surface");
  if (surface) o.settings.surface = &*surface;
  Remesh made = call(o.call, [&]() {
    requireMemory(remeshNeed("the cells", cells));
    return remeshCells(cells, *map.mapped, o.settings);
  });
  py::dict figures("inverted"_a = made.inverted, "inverted_at_rest"_a = made.invertedAtRest,
                   "inverted_carried"_a = made.invertedCarried,
                   "proof"_a = dictOf(innermap::figures(made.proof)),
                   "linear_map"_a = linearMapStatement(made.sourceProof, made.proof),
                   "swaps"_a = made.swaps, "collapses"_a = made.collapses,
                   "boundary_rms"_a = made.boundaryRms, "boundary_max"_a = made.boundaryMax,
                   "notes"_a = made.notes, "warnings"_a = made.warnings);
  return cellsObject(std::move(made.mesh), figures);
}

struct CompareOptions {
  CompareFemSettings settings;
  py::object resolutions, charges, tolerances;
  CallOptions call;

  void describe(Keywords& k) {
    k.object("resolutions", &resolutions, "list[int]",
             "cells of the tetrahedra's lattice along the longest side, 4 to 1024, ascending; 16, "
             "32, 64 if not given");
    k.object("charges", &charges, "list[int]",
             "for known functions: numbers of charges, 16 to 20000; 250, 500, 1000 if not given");
    k.object("tolerances", &tolerances, "list[float]",
             "for a map: tolerances of the fits of charges, fractions of the target's diagonal; "
             "4e-3, 1e-3, 4e-4 if not given");
    k.settings(innermap::describe(settings));
    call.describe(k);
  }
};

// The columns of the program's comparison.csv.
py::dict tableOf(const CompareFem& result) {
  py::dict out = dictOf(figures(result));
  out["notes"] = result.notes;
  return out;
}

py::object compareFem(const Arguments& a, CompareOptions& o) {
  std::size_t at = 0;
  const Mesh source = takeMesh(a, at, "source");
  takeNumbers(o.resolutions, "resolutions", o.settings.resolutions);
  takeNumbers(o.charges, "charges", o.settings.charges);
  takeNumbers(o.tolerances, "tolerances", o.settings.tolerances);
  std::optional<Mesh> target;
  if (at < a.size()) target = takeTarget(a, at, source);
  if (at < a.size()) throw py::type_error("compare_fem() takes a source and a target");
  return tableOf(call(o.call, [&]() {
    if (target) {
      const BoundaryPair pair = makeBoundaryPair(source, *target);
      requireMemory(compareFemNeed(pair.solid(), o.settings, source.vertices.size()));
      return compareFemOnMap(pair, o.settings);
    }
    const Solid solid(source);
    requireMemory(compareFemNeed(solid, o.settings, 0));
    return compareFemOnFunctions(solid, o.settings);
  }));
}

}  // namespace

void bindRemesh(py::module_& m) {
  define<RemeshOptions>(
      m,
      {"remesh", "map, cells",
       "Carries the cells that fill a map's source onto its target, none of them inverted: an "
       "innermap.Cells.\n\ncells: a Cells, a path, (points, {'tetra': array}) or a meshio.Mesh. "
       "Its point_data has source, the places that vertices came from; the two together are a "
       "piecewise linear map that push() and pull() take as `through`. Raises DataError, "
       "MemoryError."},
      remesh);
}

void bindCompareFem(py::module_& m) {
  define<CompareOptions>(
      m,
      {"compare_fem", "*meshes",
       "Finite elements and charges on the same boundary values: a dict of columns, a row for each "
       "method and size, as the program's comparison.csv has them; value_order and gradient_order "
       "of the elements.\n\ncompare_fem(V, F) compares on known harmonic functions, with relative "
       "errors of the worst of three; compare_fem(V, F, V_target) on the map. Raises DataError, "
       "MemoryError."},
      compareFem);
}

}  // namespace innermap::python
