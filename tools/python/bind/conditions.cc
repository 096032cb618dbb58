#include "bind/conditions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "bind/arrays.h"
#include "bind/call.h"
#include "bind/errors.h"
#include "bind/lists.h"
#include "innermap/io/geometry_file.h"
#include "jobs/harmonic_job.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

bool isCallable(const py::object& object) { return PyCallable_Check(object.ptr()) != 0; }

bool isMask(const py::object& object) {
  return py::array::ensure(object) && py::array::ensure(object).dtype().kind() == 'b';
}

std::vector<int> maskedTriangles(const py::array& array, const std::string& name,
                                 std::size_t count) {
  if (array.ndim() != 1 || static_cast<std::size_t>(array.shape(0)) != count)
    wrongValue(name, fmt::format("expects a mask of shape ({},), one a triangle", count));
  const auto mask = py::array_t<bool, py::array::c_style | py::array::forcecast>::ensure(array);
  std::vector<int> out;
  for (std::size_t t = 0; t < count; ++t)
    if (mask.data()[t]) out.push_back(static_cast<int>(t));
  return out;
}

std::vector<int> trianglesSelected(const py::object& object, const std::string& name,
                                   std::size_t count) {
  if (isMask(object)) return maskedTriangles(py::array::ensure(object), name, count);
  std::vector<int> out;
  for (const std::int64_t t : wholesFrom(object, name, 0, static_cast<std::int64_t>(count) - 1))
    out.push_back(static_cast<int>(t));
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

struct GroupNumbers {
  std::vector<SurfaceGroup> groups;
  Matrix numbers;
};

bool isPairs(const py::object& object) {
  return py::isinstance<py::dict>(object) || py::isinstance<py::list>(object) ||
         py::isinstance<py::tuple>(object);
}

// A dict {group: values} or pairs (triangles, values).
GroupNumbers numbersOf(const py::object& given, const std::string& name, const Groups& groups) {
  const py::list items =
      py::isinstance<py::dict>(given) ? py::list(given.attr("items")()) : py::list(given);
  if (items.empty()) wrongValue(name, "is empty");
  GroupNumbers out;
  for (const auto& item : items) {
    if (!py::isinstance<py::tuple>(item) && !py::isinstance<py::list>(item))
      wrongType(name, "expects a dict {group: values}, or pairs (triangles, values)");
    const py::sequence pair = py::reinterpret_borrow<py::sequence>(item);
    if (pair.size() != 2) wrongValue(name, "expects pairs (triangles, values)");
    out.groups.push_back(groups.select(pair[0], name));
    const std::vector<double> numbers = numbersFrom(pair[1], name);
    if (numbers.empty()) wrongValue(name, "has no value for '" + out.groups.back().name + "'");
    if (out.numbers.empty()) out.numbers = Matrix(items.size(), numbers.size());
    if (numbers.size() != out.numbers.columns())
      wrongValue(name, fmt::format("has {} values for '{}' and {} for others", numbers.size(),
                                   out.groups.back().name, out.numbers.columns()));
    for (std::size_t k = 0; k < numbers.size(); ++k)
      out.numbers(out.groups.size() - 1, k) = numbers[k];
  }
  return out;
}

// What a callable gives for so many points.
Matrix rowsFrom(const py::object& given, const std::string& name, std::size_t points) {
  return matrixFrom(given, name, points);
}

}  // namespace

Groups::Groups(const Mesh& mesh, const py::object& given) : mesh_(mesh) {
  if (given.is_none() || !py::isinstance<py::dict>(given)) return;
  read_ = true;
  for (const auto& [key, value] : py::dict(given)) {
    if (!py::isinstance<py::str>(key)) wrongType("groups", "expects a dict {name: triangles}");
    const std::string name = textFrom(key, "groups");
    groups_.push_back({name, trianglesSelected(py::reinterpret_borrow<py::object>(value),
                                               "groups['" + name + "']", mesh.triangles.size())});
  }
}

const std::vector<SurfaceGroup>& Groups::known() const {
  if (!read_ && std::filesystem::exists(mesh_.name)) groups_ = readGroups(mesh_.name, mesh_);
  read_ = true;
  return groups_;
}

SurfaceGroup Groups::select(const py::object& given, const std::string& name) const {
  if (!py::isinstance<py::str>(given))
    return {name, trianglesSelected(given, name, mesh_.triangles.size())};
  const std::string wanted = textFrom(given, name);
  if (const SurfaceGroup* group = findGroup(known(), wanted)) return *group;
  wrongValue(name, "the mesh " + noGroup(known(), wanted));
}

std::vector<SurfaceGroup> Groups::all(const py::object& names) const {
  std::vector<SurfaceGroup> out;
  if (names.is_none() || py::isinstance<py::dict>(names)) {
    for (const SurfaceGroup& group : known())
      if (py::isinstance<py::dict>(names) || !group.triangles.empty()) out.push_back(group);
    return out;
  }
  if (py::isinstance<py::str>(names) || !py::isinstance<py::iterable>(names))
    wrongType("groups", "expects a dict {name: triangles}, or names of groups of the mesh's file");
  for (const auto& name : py::iter(names)) {
    if (!py::isinstance<py::str>(name)) wrongType("groups", "expects names");
    out.push_back(select(py::reinterpret_borrow<py::object>(name), "groups"));
  }
  return out;
}

ConditionsFrom::ConditionsFrom(const Mesh& mesh, const GivenConditions& given)
    : mesh_(mesh), given_(given), groups_(mesh, given.groups) {
  if (given.values.is_none())
    fixGroups();
  else
    takeValues();
  if (!given.flux.is_none()) takeFluxes();
}

void ConditionsFrom::fixGroups() {
  if (given_.fix.is_none()) throw py::type_error("harmonic() lacks values: give `values` or `fix`");
  if (!isPairs(given_.fix))
    wrongType("fix",
              "without `values` expects a dict {group: values} or pairs (triangles, values)");
  const GroupNumbers fixed = numbersOf(given_.fix, "fix", groups_);
  conditions_ = valuesOnGroups(mesh_, fixed.groups, fixed.numbers);
}

void ConditionsFrom::takeValues() {
  if (isCallable(given_.values)) {
    conditions_.function = [values = given_.values](const Points& points) {
      return inPython([&] { return rowsFrom(values(arrayOf(points)), "values", points.size()); });
    };
    conditions_.free.assign(mesh_.triangles.size(), 0);
  } else {
    conditions_ =
        valuesAtVertices(mesh_, matrixFrom(given_.values, "values", mesh_.vertices.size(), true));
  }
  if (!given_.fix.is_none()) keepOnly(groups_.select(given_.fix, "fix"));
}

void ConditionsFrom::keepOnly(const SurfaceGroup& held) {
  std::vector<std::uint8_t> free(mesh_.triangles.size(), 1);
  for (const int t : held.triangles) free[static_cast<std::size_t>(t)] = 0;
  for (std::size_t t = 0; t < free.size(); ++t) {
    if (!free[t] && conditions_.free[t])
      wrongValue("values", fmt::format("are not known at all vertices of triangle {}, which `fix` "
                                       "names",
                                       t));
    conditions_.free[t] = free[t];
  }
}

void ConditionsFrom::takeFluxes() {
  if (isCallable(given_.flux)) {
    const auto& free = conditions_.free;
    if (std::none_of(free.begin(), free.end(), [](std::uint8_t f) { return f != 0; }))
      wrongValue("flux",
                 "is a callable, but there are values on all triangles; name those with "
                 "values by `fix`");
    conditions_.fluxFunction = [flux = given_.flux](const Points& points, const Points& normals) {
      return inPython(
          [&] { return rowsFrom(flux(arrayOf(points), arrayOf(normals)), "flux", points.size()); });
    };
    return;
  }
  if (isPairs(given_.flux)) {
    const GroupNumbers fluxes = numbersOf(given_.flux, "flux", groups_);
    setFluxes(mesh_, fluxes.groups, fluxes.numbers, conditions_);
    return;
  }
  Matrix flux = matrixFrom(given_.flux, "flux", mesh_.triangles.size(), true);
  for (std::size_t t = 0; t < flux.rows(); ++t) {
    bool is = true;
    for (std::size_t k = 0; k < flux.columns(); ++k) is = is && std::isfinite(flux(t, k));
    if (is) conditions_.free[t] = 1;
    for (std::size_t k = 0; k < flux.columns() && !is; ++k) flux(t, k) = 0;
  }
  conditions_.flux = std::move(flux);
}

}  // namespace innermap::python
