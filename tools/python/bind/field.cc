#include "bind/field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bind/arrays.h"
#include "bind/figures.h"
#include "bind/grids.h"
#include "bind/keywords.h"
#include "bind/meshes.h"
#include "bind/solids.h"
#include "innermap/core/memory.h"
#include "innermap/evaluate/grids.h"
#include "innermap/field/field_file.h"
#include "jobs/harmonic_job.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

struct SampleOptions {
  double accuracy = 1e-12;
  CallOptions call;

  void describe(Keywords& k) {
    k.number("accuracy", &accuracy, {0, 1e-3},
             "of the sums of charges, root mean square, a fraction of the values' span; a coarser "
             "one is faster for many points; 0: plain sums");
    call.describe(k);
  }
};

FieldSamples samplesOf(const PyField& field, const Points& points, bool gradients,
                       const SampleOptions& o) {
  return call(o.call, [&]() {
    EvaluateFieldSettings settings;
    settings.accuracy = o.accuracy * field.span;
    settings.gradients = gradients;
    return field.solid->field.evaluate(points, settings);
  });
}

// One channel stands for itself.
py::object squeezed(const PyField& field, const py::array& array) {
  if (!field.single()) return array;
  return array.attr("squeeze")(1);
}

py::object valuesAt(const Arguments& a, SampleOptions& o) {
  const auto& field = py::cast<const PyField&>(a[0]);
  return squeezed(field, arrayOf(samplesOf(field, pointsFrom(a[1], "X"), false, o).values));
}

py::object gradientsAt(const Arguments& a, SampleOptions& o) {
  const auto& field = py::cast<const PyField&>(a[0]);
  return squeezed(field, gradientsOf(samplesOf(field, pointsFrom(a[1], "X"), true, o).gradients));
}

struct FieldGridOptions {
  LatticeChoice grid;
  HarmonicGridSettings settings;
  CallOptions call;

  void describe(Keywords& k) {
    k.settings(innermap::describe(grid));
    k.flag("values", &settings.values, "grids NAME of the channels");
    k.flag("gradients", &settings.gradients,
           "grids NAME_gradient, vectors, values' units per world unit");
    k.flag("directions", &settings.directions, "grids NAME_direction, the gradients' unit vectors");
    k.flag("magnitudes", &settings.magnitudes, "grids NAME_magnitude, the gradients' lengths");
    call.describe(k);
  }
};

HarmonicGrids gridsOf(const PyField& field, const FieldGridOptions& o) {
  const SolidField& solid = *field.solid;
  HarmonicGrids grids = call(o.call, [&]() {
    auto settings = o.grid.in(o.settings);
    settings.span = field.span;
    requireMemory(fieldGridNeed(solid.boundary.solid, solid.names.size(), o.grid, settings));
    return evaluateHarmonic(solid.field, solid.boundary.solid, solid.names, settings);
  });
  describeField(grids.all(), solid.facts);
  return grids;
}

py::object evaluateField(const Arguments& a, FieldGridOptions& o) {
  const HarmonicGrids grids = gridsOf(py::cast<const PyField&>(a[0]), o);
  py::dict totals;
  totals["interior_voxels"] = grids.interiorVoxels;
  totals["active_voxels"] = grids.activeVoxels;
  return gridsObject(grids.all(), totals, o.call);
}

struct WriteFieldOptions : FieldGridOptions {
  NamingScheme names = NamingScheme::innermap;

  void describe(Keywords& k) {
    k.setting(namesSetting(&names));
    FieldGridOptions::describe(k);
  }
};

py::object writeFieldVdb(const Arguments& a, WriteFieldOptions& o) {
  const std::string path = pathFrom(a[1], "path");
  const HarmonicGrids grids = gridsOf(py::cast<const PyField&>(a[0]), o);
  return writeGrids(path, grids.all(), o.names, o.call);
}

py::object saveField(const Arguments& a, NoOptions&) {
  const auto solid = py::cast<const PyField&>(a[0]).solid;
  const std::string path = pathFrom(a[1], "path");
  return withoutLock([&] { writeSolidField(path, *solid); });
}

std::string fieldText(const PyField& field) {
  return fmt::format("<innermap.Field of {} in '{}': {} charges>",
                     fmt::join(field.solid->names, ", "), field.solid->boundary.mesh.name,
                     field.solid->field.sources().size());
}

void bindProperties(py::class_<PyField, std::shared_ptr<PyField>>& field) {
  field
      .def_property_readonly(
          "channels", [](const PyField& self) { return self.solid->names; }, "The channels' names.")
      .def_property_readonly(
          "boundary_error",
          [](const PyField& self) {
            return self.fit ? self.fit->error : fitFacts(self.solid->facts).error;
          },
          "The certificate, a BoundaryError: fractions of the values' span; of fluxes their error "
          "times the distance to the nearest place with a value.")
      .def_property_readonly(
          "bound",
          [](const PyField& self) {
            return self.fit
                       ? self.fit->bound
                       : factNumber(self.solid->facts, "inside_error_bound").value_or(std::nan(""));
          },
          "About the largest error of a value anywhere inside, a fraction of the values' span.")
      .def_readonly("span", &PyField::span, "The largest of the channels' given values' spans.")
      .def_property_readonly(
          "tolerance_met", [](const PyField& self) { return fitFacts(self.solid->facts).met; },
          "Whether 99% of the boundary is within the tolerance.")
      .def_property_readonly(
          "facts", [](const PyField& self) { return factsOf(self.solid->facts); },
          "What the field's file says of it, as text by name.")
      .def_property_readonly(
          "notes",
          [](const PyField& self) {
            return self.fit ? self.fit->notes : self.solid->boundary.notes;
          },
          "Notes on the way, one line each.")
      .def_property_readonly(
          "warnings",
          [](const PyField& self) {
            return self.fit ? self.fit->warnings : self.solid->boundary.warnings;
          },
          "What makes the field doubtful, a line each.")
      .def_property_readonly(
          "charges", [](const PyField& self) { return self.solid->field.sources().size(); },
          "How many charges it is the sum of.")
      .def_property_readonly(
          "source", [](const PyField& self) { return self.solid->boundary.mesh; },
          "The mesh of the solid, a Mesh.")
      .def("__repr__", &fieldText);
}

}  // namespace

std::shared_ptr<PyField> fieldOf(SolidField solid) {
  auto out = std::make_shared<PyField>();
  out->span = std::max(factNumber(solid.facts, "span").value_or(1.0), 1e-300);
  out->solid = std::make_shared<const SolidField>(std::move(solid));
  return out;
}

void bindField(py::module_& m) {
  py::class_<PyField, std::shared_ptr<PyField>> field(
      m, "Field",
      "A harmonic field inside a solid, of one or more channels. Made by harmonic(), weights() or "
      "load(). It does not change, and several threads may use it at once.");
  define<SampleOptions>(
      field,
      {"__call__", "self, X",
       "The field at points.\n\nX: (n, 3), world units, inside the solid; outside "
       "stand the field's charges. Returns (n,) of one channel, else (n, "
       "channels)."},
      valuesAt);
  define<SampleOptions>(field,
                        {"gradient", "self, X",
                         "The field's gradient at points, analytic.\n\nX: as of the field itself. "
                         "Returns (n, 3) of one channel, else (n, channels, 3): values' units per "
                         "world unit."},
                        gradientsAt);
  define<FieldGridOptions>(
      field,
      {"evaluate", "self",
       "The field on the voxels of its solid: an innermap.Grids with surface (level set), density "
       "(fog of the inside) and of each channel NAME, NAME_gradient, NAME_direction, "
       "NAME_magnitude. Raises MemoryError before the work."},
      evaluateField);
  define<WriteFieldOptions>(field,
                            {"write_vdb", "self, path",
                             "Evaluates the field as evaluate() does and writes an OpenVDB file. "
                             "Raises FileError, MemoryError."},
                            writeFieldVdb);
  define<NoOptions>(field,
                    {"save", "self, path",
                     "Writes the field's file (.ply), which load() reads. It appears whole or not "
                     "at all. Raises FileError."},
                    saveField);
  defineContains(field, [](const py::object& self) {
    return py::cast<const PyField&>(self).solid->boundary.solid;
  });
  bindProperties(field);
}

}  // namespace innermap::python
