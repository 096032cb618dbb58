#include "bind/errors.h"

#include <exception>

#include "innermap/core/error.h"
#include "jobs/frames_job.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

// They live as long as the interpreter, which may end before statics do.
struct Classes {
  PyObject *error, *file, *data, *setting, *memory, *cancelled;
};
Classes classes;

PyObject* define(py::module_& m, const char* name, const char* doc, const py::object& bases) {
  const std::string full = std::string("innermap.") + name;
  PyObject* made = PyErr_NewExceptionWithDoc(full.c_str(), doc, bases.ptr(), nullptr);
  if (!made) throw py::error_already_set();
  m.add_object(name, py::reinterpret_steal<py::object>(made));
  return made;
}

py::tuple bases(PyObject* ours, PyObject* theirs) {
  return py::make_tuple(py::handle(ours), py::handle(theirs));
}

// Paths in messages may be of any bytes.
void raise(PyObject* type, const std::exception& error) {
  const std::string text = error.what();
  PyObject* const words =
      PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "backslashreplace");
  if (!words) return;  // no memory: which is raised already
  PyErr_SetObject(type, words);
  Py_DECREF(words);
}

void translate(std::exception_ptr thrown) {  // NOLINT(performance-unnecessary-value-param)
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const FileError& e) {
    raise(classes.file, e);
  } catch (const OutputFailure& e) {
    raise(classes.file, e);
  } catch (const DataError& e) {
    raise(classes.data, e);
  } catch (const SettingError& e) {
    raise(classes.setting, e);
  } catch (const MemoryError& e) {
    raise(classes.memory, e);
  } catch (const Cancelled& e) {
    raise(classes.cancelled, e);
  } catch (const Error& e) {
    raise(classes.error, e);
  }
}

}  // namespace

void bindErrors(py::module_& m) {
  classes.error = define(m, "Error",
                         "The library's message: which file, argument or setting, what is wrong "
                         "with it and what to do.",
                         py::reinterpret_borrow<py::object>(PyExc_RuntimeError));
  classes.file = define(m, "FileError", "A file cannot be read, written or understood.",
                        bases(classes.error, PyExc_OSError));
  classes.data = define(m, "DataError",
                        "Data that are well-formed but that the computation cannot use: a mesh "
                        "with no inside, an array of the wrong shape.",
                        bases(classes.error, PyExc_ValueError));
  classes.setting = define(m, "SettingError",
                           "A setting outside its range, or settings that contradict one another.",
                           bases(classes.error, PyExc_ValueError));
  classes.memory = define(m, "MemoryError",
                          "The memory needed is known and exceeds max_memory; nothing was done.",
                          bases(classes.error, PyExc_MemoryError));
  classes.cancelled = define(m, "Cancelled", "The computation was cancelled.",
                             py::reinterpret_borrow<py::object>(classes.error));
  py::register_exception_translator(translate);
}

void wrongType(const std::string& argument, const std::string& what) {
  throw py::type_error(argument + ": " + what);
}

void wrongValue(const std::string& argument, const std::string& what) {
  throw DataError(argument + ": " + what);
}

}  // namespace innermap::python
