#include "bind/lists.h"

#include <fmt/format.h>

#include <cmath>

#include "bind/arrays.h"
#include "bind/errors.h"

namespace py = pybind11;

namespace innermap::python {

std::string textFrom(py::handle object, const std::string& name) {
  if (!py::isinstance<py::str>(object)) wrongType(name, "expects a str");
  py::ssize_t size = 0;
  const char* const text = PyUnicode_AsUTF8AndSize(object.ptr(), &size);
  if (!text) {
    PyErr_Clear();
    wrongValue(name, "has half a surrogate pair, which is no letter");
  }
  return {text, static_cast<std::size_t>(size)};
}

std::string textOf(py::handle object, const std::string& name) {
  return textFrom(py::str(object), name);
}

std::vector<std::string> textsFrom(py::handle object, const std::string& name) {
  if (object.is_none()) return {};
  if (py::isinstance<py::str>(object)) return {textFrom(object, name)};
  if (!py::isinstance<py::iterable>(object)) wrongType(name, "expects a list of texts");
  std::vector<std::string> out;
  for (const auto& item : object) {
    if (!py::isinstance<py::str>(item)) wrongType(name, "expects a list of texts");
    out.push_back(textFrom(item, name));
  }
  return out;
}

std::vector<double> numbersFrom(py::handle object, const std::string& name) {
  if (object.is_none()) return {};
  const bool one = py::isinstance<py::array>(object)
                       ? py::reinterpret_borrow<py::array>(object).ndim() == 0
                       : PyNumber_Check(object.ptr()) != 0;
  if (one) {
    py::list list;
    list.append(object);
    return numbersFrom(list, name);
  }
  if (!py::isinstance<py::sequence>(object) && !py::isinstance<py::array>(object))
    wrongType(name, "expects a number or a list of numbers");
  if (py::len(object) == 0) return {};
  const Matrix numbers = matrixFrom(object, name);
  if (numbers.columns() != 1) wrongValue(name, "expects numbers in one list");
  std::vector<double> out(numbers.rows());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = numbers(i, 0);
  return out;
}

std::vector<std::int64_t> countsFrom(py::handle object, const std::string& name) {
  std::vector<std::int64_t> out;
  for (const double n : numbersFrom(object, name)) {
    if (n < 0 || n > 1e9 || n != std::floor(n))
      wrongValue(name, fmt::format("has {}, expects whole numbers from 0", n));
    out.push_back(static_cast<std::int64_t>(n));
  }
  return out;
}

std::pair<double, double> pairFrom(py::handle object, const std::string& name) {
  const std::vector<double> numbers = numbersFrom(object, name);
  if (numbers.size() != 2)
    wrongValue(name, fmt::format("expects two numbers, got {}", numbers.size()));
  return {numbers[0], numbers[1]};
}

}  // namespace innermap::python
