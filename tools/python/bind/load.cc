// Files of maps and of fields in.
#include "bind/arrays.h"
#include "bind/call.h"
#include "bind/field.h"
#include "bind/keywords.h"
#include "bind/map.h"
#include "bind/meshes.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

struct LoadOptions {
  CallOptions call;
  void describe(Keywords& k) { call.describe(k); }
};

py::object loadAny(const Arguments& a, LoadOptions& o) {
  const std::string path = pathFrom(a[0], "path");
  const bool field = call(o.call, [&]() { return tellOfField(readField(path).facts); });
  if (field) return py::cast(fieldOf(call(o.call, [&]() { return readSolidField(path); })));
  return py::cast(std::make_shared<PyMap>(call(o.call, [&]() { return readMap(path); })));
}

}  // namespace

void bindLoad(py::module_& m) {
  define<LoadOptions>(m,
                      {"load", "path",
                       "Reads the file of a map or of a harmonic field, as save() or the program "
                       "wrote it: a Map or a Field. Raises "
                       "FileError."},
                      loadAny);
}

}  // namespace innermap::python
