#include "bind/correspondence.h"

#include <fmt/format.h>

#include "bind/arrays.h"
#include "bind/errors.h"
#include "bind/figures.h"
#include "bind/meshes.h"
#include "innermap/core/error.h"
#include "innermap/io/geometry_file.h"
#include "innermap/mesh/mesh_file.h"
#include "report/figures.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

LandmarkPlace placeFrom(const py::object& object) {
  LandmarkPlace place;
  if (PyIndex_Check(object.ptr()) && !py::isinstance<py::array>(object)) {
    int overflow = 0;
    const long long vertex = PyLong_AsLongLongAndOverflow(py::int_(object).ptr(), &overflow);
    if (overflow != 0 || vertex < 0 || vertex > std::numeric_limits<int>::max())
      wrongValue("landmarks", "a vertex is counted from 0");
    place.vertex = static_cast<int>(vertex);
    return place;
  }
  const Matrix point = matrixFrom(object, "landmarks");
  if (point.rows() != 3 || point.columns() != 1)
    wrongValue("landmarks", "a place is the number of a vertex or three coordinates");
  place.point = {point(0, 0), point(1, 0), point(2, 0)};
  return place;
}

LandmarkList landmarksFrom(const py::object& given) {
  if (isPath(given)) return readLandmarks(pathFrom(given, "landmarks"));
  LandmarkList out;
  if (!py::isinstance<py::iterable>(given))
    wrongType("landmarks", "expects a list of pairs of places, or a path");
  for (const auto& pair : py::iter(given)) {
    if (!py::isinstance<py::sequence>(pair) && !py::isinstance<py::array>(pair))
      wrongType("landmarks", "expects pairs of places");
    if (py::len(pair) != 2)
      wrongValue("landmarks", "expects pairs: a place on the first mesh, one on the second");
    const auto place = [&](int i) { return placeFrom(py::object(pair[py::int_(i)])); };
    LandmarkPair both;
    both.onA = place(0);
    both.onB = place(1);
    out.pairs.push_back(both);
  }
  if (out.pairs.empty()) wrongValue("landmarks", "is empty");
  return out;
}

std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

py::array trianglesOf(const PyCorrespondence& c) {
  std::vector<std::int32_t> out;
  for (const SurfacePoint& p : c.onTarget) out.push_back(p.triangle);
  return arrayOf(out);
}

py::array barycentricOf(const PyCorrespondence& c) {
  Points out;
  for (const SurfacePoint& p : c.onTarget)
    out.push_back({p.barycentric[0], p.barycentric[1], p.barycentric[2]});
  return arrayOf(out);
}

struct CorrespondCall : CorrespondOptions {
  CallOptions call;
  void describe(Keywords& k) {
    CorrespondOptions::describe(k);
    k.setting(seedSetting(&map.seed));
    call.describe(k);
    call.describeTime(k);
  }
};

py::object correspondTwo(const Arguments& a, CorrespondCall& o) {
  std::size_t at = 0;
  const Mesh first = takeMesh(a, at, "source"), second = takeMesh(a, at, "target");
  if (at < a.size()) throw py::type_error("correspond() takes a source and a target, no more");
  return py::cast(correspondMeshes(first, second, o.settings(), o.call));
}

// As the program does: where triangles were split, the source stands beside.
py::object saveCorrespondence(const Arguments& a, NoOptions&) {
  const auto& self = py::cast<const PyCorrespondence&>(a[0]);
  const std::string path = pathFrom(a[1], "path");
  if (path.size() < 5 || path.compare(path.size() - 4, 4, ".ply") != 0)
    wrongValue("path", "must end in .ply, got '" + path + "'");
  return withoutLock([&] {
    if (self.onTarget.empty()) return writeMesh(path, self.target(self.source.name));
    if (self.changed) {
      Mesh source = self.source;
      source.colours.clear();
      writeMesh(path.substr(0, path.size() - 4) + ".source.ply", source);
    }
    writeCorrespondence(path, self.source, self.positions, self.onTarget);
  });
}

// A file of the program has addresses beside the places; any other mesh may serve too.
std::vector<SurfacePoint> addressesIn(const std::string& path, const Mesh& source) {
  Matrix values;
  try {
    values = readVertexProperties(path, {"triangle", "b0", "b1", "b2"}, source);
  } catch (const FileError&) {
    return {};
  }
  std::vector<SurfacePoint> out(values.rows());
  for (std::size_t v = 0; v < out.size(); ++v) {
    if (!(values(v, 0) >= 0 && values(v, 0) < 2147483648.0)) return {};
    out[v].triangle = static_cast<int>(values(v, 0));
    for (std::size_t k = 0; k < 3; ++k) out[v].barycentric[k] = values(v, k + 1);
  }
  return out;
}

py::object loadCorrespondence(const Arguments& a, CallOptions& o) {
  if (a.empty()) throw py::type_error("load_correspondence() lacks its argument 'path'");
  const std::string path = pathFrom(a[0], "path");
  std::size_t at = 1;
  auto out = std::make_shared<PyCorrespondence>();
  out->source = takeMesh(a, at, "source");
  runCall(o, [&]() {
    out->positions = readCorrespondence(path, out->source).vertices;
    out->onTarget = addressesIn(path, out->source);
  });
  return py::cast(out);
}

std::string correspondenceText(const PyCorrespondence& c) {
  return fmt::format("<innermap.Correspondence: {} vertices of '{}'>", c.positions.size(),
                     c.source.name);
}

}  // namespace

Mesh PyCorrespondence::target(const std::string& name) const {
  Mesh out = source;
  out.name = name;
  out.vertices = positions;
  return out;
}

void CorrespondOptions::describe(Keywords& k) {
  k.object("landmarks", &landmarks, "Sequence[tuple[place, place]] or path",
           "pairs that are kept exactly, a place on the source and one on the target: the number "
           "of a vertex, or three coordinates; or a file as the program reads it");
  k.settings(without(innermap::describe(map), {"seed"}));
  describeClose(k, &close);
}

MeshCorrespondenceSettings CorrespondOptions::settings() const {
  MeshCorrespondenceSettings out = map;
  if (!landmarks.is_none()) out.landmarks = landmarksFrom(landmarks);
  return out;
}

std::shared_ptr<PyCorrespondence> correspondMeshes(const Mesh& a, const Mesh& b,
                                                   const MeshCorrespondenceSettings& settings,
                                                   const CallOptions& options) {
  const MeshCorrespondence made = call(options, [&]() {
    requireMemory(correspondNeed(a.vertices.size(), b.vertices.size()));
    return innermap::correspondMeshes(a, b, settings);
  });
  auto out = std::make_shared<PyCorrespondence>();
  out->source = made.source;
  out->positions = made.positions;
  out->onTarget = made.onTarget;
  out->changed = made.changed;
  out->notes = joined(joined(made.a.notes, made.b.notes), made.notes);
  out->warnings = made.warnings;
  out->quality = dictOf(correspondenceFigures(&made));
  return out;
}

void bindCorrespondence(py::module_& m) {
  py::class_<PyCorrespondence, std::shared_ptr<PyCorrespondence>> c(
      m, "Correspondence",
      "Where the vertices of one mesh, the source, lie on another. fit() takes it in place of its "
      "meshes.");
  c.def_readonly("source", &PyCorrespondence::source,
                 "The source, a Mesh: as given, or with its triangles split; its own vertices come "
                 "first.")
      .def_property_readonly(
          "target", [](const PyCorrespondence& self) { return self.target(self.source.name); },
          "The same mesh with its vertices on the target, a Mesh.")
      .def_property_readonly(
          "positions", [](const PyCorrespondence& self) { return arrayOf(self.positions); },
          "(n, 3) float64: the places of the source's vertices, world units of the target.")
      .def_property_readonly("triangles", &trianglesOf,
                             "(n,) int32: the triangle of the target that each lies on; empty "
                             "where a file does not say.")
      .def_property_readonly("barycentric", &barycentricOf, "(n, 3) float64: and where in it.")
      .def_readonly("changed", &PyCorrespondence::changed,
                    "Whether the source's triangles were split or parts of it cut apart.")
      .def_readonly("quality", &PyCorrespondence::quality,
                    "Figures by name: flips, degree, energies, stretch, deviation from the target "
                    "(shares of its diagonal), landmark_error; empty where it was read.")
      .def_readonly("notes", &PyCorrespondence::notes, "What was done, a line each.")
      .def_readonly("warnings", &PyCorrespondence::warnings, "What makes it doubtful, a line each.")
      .def("__repr__", &correspondenceText);
  define<NoOptions>(c,
                    {"save", "self, path",
                     "Writes the places to a .ply file, which load_correspondence() and the "
                     "program read; where triangles were split, also the source, to "
                     "NAME.source.ply. Raises FileError."},
                    saveCorrespondence);
  define<CorrespondCall>(
      m,
      {"correspond", "*meshes",
       "Lays the surface of one solid onto that of another, of any connectivity: one-to-one, each "
       "point of the target reached once.\n\nmeshes: the source and the target, each as V, F or "
       "anything that stands for a mesh; both closed, with as many handles and as many shells. "
       "Returns a Correspondence. Raises DataError, MemoryError."},
      correspondTwo);
  define<CallOptions>(m,
                      {"load_correspondence", "path, *source",
                       "Reads the places of a mesh's vertices on another, as "
                       "Correspondence.save() or the program wrote them. source: the mesh that "
                       "was laid on the other; NAME.source.ply where there is one. Raises "
                       "FileError, DataError for another mesh."},
                      loadCorrespondence);
}

}  // namespace innermap::python
