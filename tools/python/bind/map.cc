#include "bind/map.h"

#include <fmt/format.h>

#include <cmath>

#include "bind/arrays.h"
#include "bind/figures.h"
#include "bind/keywords.h"
#include "bind/meshes.h"
#include "bind/solids.h"
#include "innermap/field/field_file.h"
#include "innermap/proof/prove.h"
#include "report/figures.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

// Of the sums of charges, of the target's diagonal: some hundred times what doubles hold.
constexpr double kUsualAccuracy = 1e-12;

struct CallMapOptions {
  bool jacobian = false;
  double accuracy = kUsualAccuracy;
  CallOptions call;

  void describe(Keywords& k) {
    k.flag("jacobian", &jacobian, "also the derivative of the map at each point");
    k.number("accuracy", &accuracy, {0, 1e-3},
             "of the sums of charges, root mean square, a fraction of the target's diagonal; a "
             "coarser one is faster for many points; 0: plain sums");
    call.describe(k);
  }
};

py::object callMap(const Arguments& a, CallMapOptions& o) {
  const auto& map = py::cast<const PyMap&>(a[0]);
  const Points points = pointsFrom(a[1], "X");
  FieldSamples samples = call(o.call, [&]() {
    EvaluateFieldSettings settings;
    settings.accuracy = o.accuracy * map.diagonal();
    settings.gradients = o.jacobian;
    return map.mapped->map.evaluate(points, settings);
  });
  if (!o.jacobian) return arrayOf(std::move(samples.values));
  return py::make_tuple(arrayOf(std::move(samples.values)),
                        gradientsOf(std::move(samples.gradients)));
}

struct InverseOptions {
  bool jacobian = false;
  CallOptions call;

  void describe(Keywords& k) {
    k.flag("jacobian", &jacobian, "also the derivative of the inverse at each point");
    call.describe(k);
  }
};

py::object inverseMap(const Arguments& a, InverseOptions& o) {
  const auto& map = py::cast<const PyMap&>(a[0]);
  const Points points = pointsFrom(a[1], "Y");
  return carriedTuple(call(o.call, [&]() { return map.puller().pull(points, o.jacobian); }),
                      o.jacobian);
}

py::object saveMap(const Arguments& a, NoOptions&) {
  const auto mapped = py::cast<const PyMap&>(a[0]).mapped;
  const std::string path = pathFrom(a[1], "path");
  return withoutLock([&] { writeMap(path, *mapped); });
}

struct ProveOptions {
  ProofSettings settings;
  bool full = false;
  CallOptions call;

  void describe(Keywords& k) {
    k.settings(innermap::describe(settings));
    k.flag("full", &full, "that no two points go to one, too; takes longer");
    call.describe(k);
  }
};

py::object prove(const Arguments& a, ProveOptions& o) {
  const auto mapped = py::cast<const PyMap&>(a[0]).mapped;
  return dictOf(figures(
      call(o.call, [&]() { return proveMap(mapped->map, mapped->boundary, o.settings, o.full); })));
}

struct ProofCellsOptions {
  ProofSettings settings;
  CallOptions call;

  void describe(Keywords& k) {
    std::vector<Setting> known = innermap::describe(settings);
    known.pop_back();  // of the boundary
    k.settings(known);
    call.describe(k);
  }
};

py::object cellsArray(const ProofCells& cells) {
  Matrix out(cells.places.size(), 4);
  for (std::size_t i = 0; i < cells.places.size(); ++i) {
    for (int k = 0; k < 3; ++k) out(i, static_cast<std::size_t>(k)) = cells.places[i].center[k];
    out(i, 3) = cells.places[i].halfEdge;
  }
  return arrayOf(std::move(out));
}

py::object proofCells(const Arguments& a, ProofCellsOptions& o) {
  const auto mapped = py::cast<const PyMap&>(a[0]).mapped;
  o.settings.keepProven = true;
  const SenseProof proof = call(o.call, [&]() {
    return proveSense(mapped->map, mapped->solid().repaired().mesh, o.settings);
  });
  return py::make_tuple(cellsArray(proof.proven), cellsArray(proof.undecided),
                        cellsArray(proof.negative));
}

using VerifyOptions = SettingsOptions<VerifySettings>;

py::object verify(const Arguments& a, VerifyOptions& o) {
  const auto mapped = py::cast<const PyMap&>(a[0]).mapped;
  return dictOf(figures(call(o.call, [&]() { return verifyMap(*mapped, o.settings); })));
}

std::string mapText(const PyMap& map) {
  const MappedSolid& mapped = *map.mapped;
  return fmt::format(
      "<innermap.Map of '{}' onto '{}': {} charges{}>", mapped.boundary.source.mesh.name,
      mapped.boundary.targetMesh.name, mapped.map.sources(),
      mapped.map.steps().size() > 1 ? fmt::format(" in {} steps", mapped.map.steps().size()) : "");
}

std::vector<std::string> notesOf(const PyMap& map) {
  return map.fit ? map.fit->notes : map.mapped->boundary.notes;
}

std::vector<std::string> warningsOf(const PyMap& map) {
  return map.fit ? map.fit->warnings : map.mapped->boundary.warnings;
}

Mesh targetOf(const PyMap& map) { return map.mapped->boundary.targetMesh; }

}  // namespace

PointPuller PyMap::puller() const {
  const std::lock_guard<std::mutex> guard(inverse_->making);
  if (!inverse_->made) {
    CarryPointsSettings settings;
    settings.accuracy = kUsualAccuracy;
    const Solid target = makeTargetSolid(mapped->boundary);
    inverse_->made = PointPuller(mapped->map, mapped->solid(), target, settings);
  }
  return *inverse_->made;
}

py::tuple carriedTuple(CarriedPoints carried, bool jacobians) {
  py::array_t<bool> found(static_cast<py::ssize_t>(carried.points.size()));
  bool* is = found.mutable_data();
  for (std::size_t i = 0; i < carried.points.size(); ++i) {
    is[i] = carried.fates[i] == PointFate::carried;
    if (is[i]) continue;
    carried.points[i] = {std::nan(""), std::nan(""), std::nan("")};
    if (jacobians)
      for (auto& row : carried.jacobians[i]) row.fill(std::nan(""));
  }
  if (!jacobians) return py::make_tuple(arrayOf(carried.points), found);
  return py::make_tuple(arrayOf(carried.points), found, arrayOf(carried.jacobians));
}

void bindMap(py::module_& m) {
  py::class_<PyMap, std::shared_ptr<PyMap>> map(
      m, "Map",
      "The map of a solid: harmonic, or several harmonic maps one after the other. Made by fit() "
      "or load(). It does not change, and several threads may use it at once.");
  define<CallMapOptions>(
      map,
      {"__call__", "self, X",
       "Where points go.\n\nX: (n, 3), world units of the source, inside the solid; outside stand "
       "the map's charges. Returns Y, (n, 3), world units of the target, or, with jacobian=True, "
       "Y and J, (n, 3, 3): J[i, r, a] is the derivative of Y[i, r] by X[i, a]. Arrays are in "
       "Fortran's order, column after column."},
      callMap);
  define<InverseOptions>(
      map,
      {"inverse", "self, Y",
       "Where points come from.\n\nY: (n, 3), world units of the target. Returns X, (n, 3), world "
       "units of the source, with m(X) = Y, and found, (n,) bool; where nothing of the source "
       "comes to a point, X is NaN and found False. Where the map folds, several points come to "
       "one: X is one of them. With jacobian=True also the derivative of the inverse, (n, 3, 3). "
       "The first call inverts the map on a grid, which takes some seconds and is kept."},
      inverseMap);
  defineContains(
      map, [](const py::object& self) { return py::cast<const PyMap&>(self).mapped->solid(); });
  define<NoOptions>(map,
                    {"save", "self, path",
                     "Writes the map's file (.ply), which load() and the program read. It appears "
                     "whole or not at all. Raises FileError."},
                    saveMap);
  define<ProveOptions>(
      map,
      {"prove", "self",
       "Where the map folds nowhere, proven on whole cells of the solid, and how far its boundary "
       "is off at most, proven too.\n\nReturns a dict, with the keys that one_to_one has for its "
       "proof; fit() proves as much with fewer cells. Raises DataError where the solid's surface "
       "is "
       "not closed."},
      prove);
  define<ProofCellsOptions>(
      map,
      {"proof_cells", "self",
       "The cubes on which prove() decides where the map folds.\n\nReturns three arrays, (n, 4), "
       "the largest cubes first: where the map is proven not to fold, where nothing is decided, "
       "and "
       "where it is proven to fold everywhere. Each row holds the cube's centre and half its edge, "
       "world units of the source. Raises as prove()."},
      proofCells);
  define<VerifyOptions>(
      map,
      {"verify", "self",
       "Proves again what the map's facts claim to be proven of it, from its charges, its mesh and "
       "where that goes; see load().\n\nReturns a dict: any, whether something is claimed; holds, "
       "whether each claim does; lists claims, claimed, found and results, a text each for every "
       "claim: \"holds\", \"fails\" or \"cannot be shown\"; under proven what came out here."},
      verify);
  map.def_property_readonly(
         "boundary_error",
         [](const PyMap& self) {
           return self.fit ? self.fit->error : fitFacts(self.mapped->facts).error;
         },
         "The certificate, a BoundaryError: fractions of the target's diagonal.")
      .def_property_readonly(
          "tolerance_met", [](const PyMap& self) { return fitFacts(self.mapped->facts).met; },
          "Whether 99% of the boundary is within the tolerance; None where the "
          "map was not fitted to one.")
      .def_property_readonly(
          "statement",
          [](const PyMap& self) { return injectivityStatement(self.mapped->injectivity); },
          "Whether the map is one-to-one: what innermap checked and found, and what follows.")
      .def_property_readonly(
          "one_to_one", [](const PyMap& self) { return dictOf(figures(self.mapped->injectivity)); },
          "The figures of the statement, by name.")
      .def_property_readonly(
          "facts", [](const PyMap& self) { return factsOf(self.mapped->facts); },
          "What the map's file says of it: settings and results, as text by name.")
      .def_property_readonly("notes", &notesOf, "Notes on the way, one line each.")
      .def_property_readonly("warnings", &warningsOf, "What makes the map doubtful, a line each.")
      .def_property_readonly(
          "steps", [](const PyMap& self) { return self.mapped->map.steps().size(); },
          "Number of harmonic maps that it chains.")
      .def_property_readonly(
          "charges", [](const PyMap& self) { return self.mapped->map.sources(); },
          "Charges of all steps.")
      .def_property_readonly(
          "source", [](const PyMap& self) { return self.mapped->boundary.source.mesh; },
          "The mesh that is mapped, a Mesh.")
      .def_property_readonly("target", &targetOf,
                             "The same mesh with its vertices where the map takes them, a Mesh.")
      .def_property_readonly(
          "volumes",
          [](const PyMap& self) {
            return py::make_tuple(self.mapped->solid().volume(),
                                  self.mapped->boundary.target.volume);
          },
          "Of source and target, world units cubed.")
      .def("__repr__", &mapText);
}

}  // namespace innermap::python
