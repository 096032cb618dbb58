// Arrays in and out. What comes in is checked: shape, kind of numbers, finite. What goes out is a
// new array, in C order but for matrices.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <limits>
#include <string>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"
#include "innermap/mesh/mesh.h"

namespace innermap::python {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();  // where a row has no value

// `name` is the argument, as messages call it. Anything that numpy takes for an array of real
// numbers; throw TypeError for other kinds, innermap.DataError for shapes and values.
Points pointsFrom(pybind11::handle array, const std::string& name);  // (n, 3), n may be 0
// (m, 3) whole numbers in [0, vertices).
std::vector<Triangle> trianglesFrom(pybind11::handle array, const std::string& name,
                                    std::size_t vertices);
// (n, k) or (n,), which is one column. rows: wanted; 0: any.
Matrix matrixFrom(pybind11::handle array, const std::string& name, std::size_t rows = 0,
                  bool mayBeNan = false);
// (n,) whole numbers in [least, most].
std::vector<std::int64_t> wholesFrom(pybind11::handle array, const std::string& name,
                                     std::int64_t least, std::int64_t most);
// Whether it is a numpy array or a list, and not a tuple.
bool isArrayLike(pybind11::handle object);

pybind11::array_t<double> arrayOf(const Points& points);                // (n, 3)
pybind11::array_t<double> arrayOf(const std::vector<Mat3>& matrices);   // (n, 3, 3)
pybind11::array_t<std::int32_t> arrayOf(const std::vector<Triangle>&);  // (m, 3)
pybind11::array_t<double> arrayOf(const Vec3& vector);                  // (3,)
// A matrix's own memory, column by column: copying it takes a tenth of the time that many points
// take.
pybind11::array_t<double> arrayOf(Matrix matrix);         // (n, k)
pybind11::array_t<double> gradientsOf(Matrix gradients);  // n x 3k: (n, k, 3)
template <class Number>
pybind11::array_t<Number> arrayOf(const std::vector<Number>& values) {  // (n,)
  return pybind11::array_t<Number>(static_cast<pybind11::ssize_t>(values.size()), values.data());
}

}  // namespace innermap::python
