// harmonic() and weights().
#include <fmt/format.h>

#include "bind/conditions.h"
#include "bind/errors.h"
#include "bind/field.h"
#include "bind/keywords.h"
#include "bind/lists.h"
#include "bind/meshes.h"
#include "jobs/harmonic_job.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

struct FieldFitOptions {
  HarmonicFitSettings fit;
  double creaseAngle = BoundaryConditions{}.creaseAngle;
  CallOptions call;

  void describe(Keywords& k) {
    k.settings(innermap::describe(fit));
    k.setting(creaseSetting(&creaseAngle));
    call.describe(k);
  }
};

struct HarmonicOptions {
  GivenConditions given;
  py::object names = py::none();
  FieldFitOptions fit;

  void describe(Keywords& k) {
    k.object("values", &given.values, "array or Callable[[array], array]",
             "(n,) or (n, channels) at the vertices, linear on triangles, NaN where a vertex has "
             "none: nothing flows through the triangles about it then; or a callable that takes "
             "(p, 3) points of the surface and gives (p,) or (p, channels), exact between vertices "
             "too");
    k.object("fix", &given.fix, "dict, pairs, or triangles",
             "without `values`: {group: value(s)} or pairs (triangles, value(s)); with `values`: "
             "the triangles on which they hold. Nothing flows through all others unless `flux` "
             "says otherwise. triangles: (m,) bool, whole numbers, or a group's name");
    k.object("flux", &given.flux, "dict, pairs, array or Callable[[array, array], array]",
             "derivatives along the outward normal, values' units per world unit: {group: "
             "value(s)}, pairs (triangles, value(s)), (m,) or (m, channels) with NaN where there "
             "is none, or a callable that takes points and outward unit normals, for all triangles "
             "without values");
    k.object("groups", &given.groups, "dict[str, array]",
             "triangles by name, for `fix` and `flux`; groups, objects and materials of the file "
             "if the mesh was read from an OBJ");
    k.object("names", &names, "Sequence[str]",
             "of the channels' grids; 'value', or 'value0', 'value1', ... if not given");
    fit.describe(k);
  }
};

std::vector<std::string> namesFrom(const py::object& given, std::size_t channels) {
  if (given.is_none()) return channelNames(channels);
  if (py::isinstance<py::str>(given) || !py::isinstance<py::iterable>(given))
    wrongType("names", "expects a list of the channels' names");
  std::vector<std::string> out;
  for (const auto& name : py::iter(given)) out.push_back(textOf(name, "names"));
  if (out.size() != channels)
    wrongValue("names", fmt::format("has {} for {} channels", out.size(), channels));
  return out;
}

std::shared_ptr<PyField> fitted(const Mesh& mesh, BoundaryConditions& conditions,
                                const py::object& names, const FieldFitOptions& o) {
  if (!conditions.function) namesFrom(names, conditions.values.columns());  // before the work
  auto made = call(o.call, [&]() {
    requireMemory(harmonicNeed(mesh.vertices.size()));
    HarmonicJob job = harmonicJob(mesh, std::move(conditions), o.creaseAngle);
    HarmonicFit fit = job.fit(o.fit);
    return std::make_pair(std::move(job.boundary), std::move(fit));
  });
  auto& [boundary, fit] = made;
  std::vector<std::string> channels = namesFrom(names, fit.field.channels());
  Facts facts = harmonicFacts(fit, o.fit, mesh.name, channels);
  auto out = fieldOf({fit.field, std::move(boundary), std::move(channels), std::move(facts)});
  out->span = std::max(fit.span, 1e-300);
  out->fit = std::move(fit);
  return out;
}

py::object harmonic(const Arguments& a, HarmonicOptions& o) {
  std::size_t at = 0;
  const Mesh mesh = takeMesh(a, at, "mesh");
  if (at < a.size()) {
    if (!o.given.values.is_none()) throw py::type_error("harmonic() has `values` twice");
    o.given.values = a[at++];
  }
  if (at < a.size()) throw py::type_error("harmonic() takes a mesh and values, no more");
  ConditionsFrom conditions(mesh, o.given);
  return py::cast(fitted(mesh, conditions.conditions(), o.names, o.fit));
}

struct WeightOptions {
  py::object groups = py::none();
  FieldFitOptions fit;

  WeightOptions() { fit.fit.tolerance = kWeightsTolerance; }
  void describe(Keywords& k) {
    k.object("groups", &groups, "dict[str, array] or Sequence[str]",
             "triangles by name, whole numbers or (m,) bool; or names of groups, objects and "
             "materials of the OBJ that the mesh was read from, all that have faces if not given");
    fit.describe(k);
  }
};

py::object weights(const Arguments& a, WeightOptions& o) {
  std::size_t at = 0;
  const Mesh mesh = takeMesh(a, at, "mesh");
  if (at < a.size()) {
    if (!o.groups.is_none()) throw py::type_error("weights() has `groups` twice");
    o.groups = a[at++];
  }
  if (at < a.size()) throw py::type_error("weights() takes a mesh and groups, no more");
  const std::vector<SurfaceGroup> groups = Groups(mesh, o.groups).all(o.groups);
  py::list names;
  for (const SurfaceGroup& group : groups) names.append(group.name);
  BoundaryConditions conditions = weightConditions(mesh, groups);
  return py::cast(fitted(mesh, conditions, names, o.fit));
}

}  // namespace

void bindHarmonic(py::module_& m) {
  define<HarmonicOptions>(
      m,
      {"harmonic", "*mesh_and_values",
       "A harmonic field inside a solid, from values on its surface; no tetrahedra are needed. "
       "Returns an innermap.Field.\n\nharmonic(V, F, values): any number of channels in one "
       "solve.\nharmonic(V, F, fix=[(inner, 0), (outer, 1)]): values on parts of the surface, "
       "nothing flows through the rest.\nharmonic('heart.obj', fix={'endo': 0, 'epi': 1}): by the "
       "file's groups.\n\nV: (n, 3) float64, world units. F: (m, 3) integers; or anything that "
       "stands for a mesh. A tolerance that cannot be met is no error, see Field.tolerance_met. "
       "Points and lines inside cannot hold a value in three dimensions: give them as small balls "
       "or tubes, closed parts of the surface. Raises DataError, SettingError, MemoryError."},
      harmonic);
  define<WeightOptions>(
      m,
      {"weights", "*mesh_and_groups",
       "Compute harmonic weights inside a solid from groups of its surface. Each group gets a "
       "channel: 1 on the group, 0 on the others, and no flux through the rest. Weights sum to 1 "
       "everywhere. Where groups touch, weights blend over the triangles along the border. Returns "
       "an innermap.Field with the groups' names.\n\nweights(V, F, {'head': head, 'arm': "
       "arm})\nweights('body.obj', ['head', 'arm'])\n\nRaises DataError: fewer than two groups, "
       "one without triangles (a point or a line inside cannot hold a weight: give it as a small "
       "ball or tube), a triangle in two of them."},
      weights);
}

}  // namespace innermap::python
