// Files of maps and of fields in.
#include "bind/call.h"
#include "bind/field.h"
#include "bind/keywords.h"
#include "bind/map.h"
#include "bind/meshes.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

py::object loadAny(const Arguments& a, CallOptions& o) {
  const std::string path = pathFrom(a[0], "path");
  const bool field = call(o, [&]() { return tellOfField(readField(path).facts); });
  if (field) return py::cast(fieldOf(call(o, [&]() { return readSolidField(path); })));
  return py::cast(std::make_shared<PyMap>(call(o, [&]() { return readMap(path); })));
}

}  // namespace

void bindLoad(py::module_& m) {
  define<CallOptions>(m,
                      {"load", "path",
                       "Reads the file of a map or of a harmonic field, as save() or the program "
                       "wrote it: a Map or a Field. Raises "
                       "FileError."},
                      loadAny);
}

}  // namespace innermap::python
