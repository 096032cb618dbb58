// What is wrong with a mesh.
#include "innermap/mesh/check.h"

#include <fmt/format.h>

#include "bind/arrays.h"
#include "bind/keywords.h"
#include "bind/meshes.h"
#include "innermap/core/memory.h"

namespace py = pybind11;
using namespace py::literals;

namespace innermap::python {
namespace {

struct CheckOptions {
  bool selfIntersections = true;
  CallOptions call;

  void describe(Keywords& k) {
    k.flag("self_intersections", &selfIntersections, "look for triangles that pass through others");
    call.describe(k);
  }
};

py::object check(const Arguments& a, CheckOptions& o) {
  const Mesh mesh = onlyMesh(a, "check");
  return py::cast(call(o.call, [&]() {
    requireMemory({"checking the mesh", checkMemory(mesh)});
    CheckSettings settings;
    settings.selfIntersections = o.selfIntersections;
    return checkMesh(mesh, settings);
  }));
}

py::list findingsOf(const MeshReport& report) {
  py::list out;
  for (const Finding& finding : findings(report)) {
    py::dict one("name"_a = finding.name, "count"_a = finding.count, "what"_a = finding.what,
                 "meaning"_a = finding.meaning);
    out.append(one);
  }
  return out;
}

std::string checkText(const MeshReport& report) {
  std::string out = fmt::format("<innermap.MeshReport: {} vertices, {} triangles", report.vertices,
                                report.triangles);
  for (const Finding& finding : findings(report)) out += "; " + finding.what;
  return out + ">";
}

Points crossingsOf(const MeshReport& report) {
  Points out;
  for (const Crossing& crossing : report.crossings) out.push_back(crossing.place);
  return out;
}

}  // namespace

void bindCheck(py::module_& m) {
  py::class_<MeshReport>(m, "MeshReport", "What check() found of a mesh.")
      .def_readonly("vertices", &MeshReport::vertices, "How many.")
      .def_readonly("triangles", &MeshReport::triangles, "How many.")
      .def_readonly("components", &MeshReport::components, "Connected by shared vertices.")
      .def_readonly("closed", &MeshReport::closed, "No edge lacks a triangle.")
      .def_readonly("open_loops", &MeshReport::openLoops, "Holes, which are capped for a solid.")
      .def_readonly("genus", &MeshReport::genus, "Handles of all components.")
      .def_readonly("outward", &MeshReport::outward, "Whether triangles face outward.")
      .def_readonly("self_intersections", &MeshReport::selfIntersections,
                    "Pairs of triangles that pass through each other.")
      .def_property_readonly(
          "crossings", [](const MeshReport& r) { return arrayOf(crossingsOf(r)); },
          "(k, 3): where the first 20 of them do.")
      .def_readonly("area", &MeshReport::area, "World units squared.")
      .def_readonly("volume", &MeshReport::volume,
                    "Signed, with the holes capped; world units cubed.")
      .def_property_readonly(
          "box",
          [](const MeshReport& r) {
            return arrayOf(Points{r.box.lower, r.box.upper});
          },
          "(2, 3): its lower and its upper corner.")
      .def_property_readonly("findings", &findingsOf,
                             "What is worth telling, most serious first: dicts of name, count, "
                             "what, meaning; empty for a clean closed mesh.")
      .def("__repr__", &checkText);
  define<CheckOptions>(m,
                       {"check", "*mesh",
                        "Check a mesh: each fault, and its meaning for a map. Returns a "
                        "MeshReport.\n\nmesh: V, F or anything that stands for a mesh."},
                       check);
}

}  // namespace innermap::python
