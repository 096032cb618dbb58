#include "bind/arrays.h"

#include <fmt/format.h>

#include <cmath>

#include "bind/errors.h"
#include "innermap/core/run.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

constexpr std::size_t kBlock = 1 << 14;  // rows

std::string shapeOf(const py::array& array) {
  return py::cast<std::string>(py::str(array.attr("shape")));
}

// numpy's own view of it, of a kind among `kinds` ("fiu").
py::array arrayFrom(py::handle object, const std::string& name, const char* kinds,
                    const char* what) {
  if (object.is_none()) wrongType(name, fmt::format("expects {}, got None", what));
  const py::array array = py::array::ensure(object);
  if (!array) {
    PyErr_Clear();
    wrongType(name, fmt::format("expects {}, got {}", what,
                                py::cast<std::string>(py::type::of(object).attr("__name__"))));
  }
  const bool known = std::string(kinds).find(array.dtype().kind()) != std::string::npos;
  // An empty list is of floats for numpy.
  if (!known && array.size() > 0)
    wrongType(name, fmt::format("expects {}, got an array of {}", what,
                                py::cast<std::string>(py::str(array.dtype()))));
  return array;
}

template <class Number>
using Plain = py::array_t<Number, py::array::c_style | py::array::forcecast>;

template <class Number>
Plain<Number> plain(const py::array& array) {
  Plain<Number> out = Plain<Number>::ensure(array);
  if (!out) throw py::error_already_set();
  return out;
}

std::size_t rowsOf(const py::array& array) { return static_cast<std::size_t>(array.shape(0)); }

// A new array of the shape, its rows filled by all threads.
template <class Row>
py::array_t<double> filled(const std::vector<py::ssize_t>& shape, const Row& row) {
  py::array_t<double> out(shape);
  const auto rows = static_cast<std::size_t>(shape.front());
  const std::size_t width = rows == 0 ? 0 : static_cast<std::size_t>(out.size()) / rows;
  double* to = out.mutable_data();
  {
    const py::gil_scoped_release unlocked;
    parallelBlocks(rows, kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) row(i, to + i * width);
    });
  }
  return out;
}

py::ssize_t signedSize(std::size_t size) { return static_cast<py::ssize_t>(size); }

constexpr py::ssize_t kSize = sizeof(double);

// A matrix that lives as long as the arrays of its memory.
std::pair<Matrix*, py::capsule> keptBy(Matrix matrix) {
  auto* kept = new Matrix(std::move(matrix));
  return {kept, py::capsule(kept, [](void* m) { delete static_cast<Matrix*>(m); })};
}

// Without first filling what is written anyway.
Points copied(const double* numbers, std::size_t rows) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double), "three doubles");
  const auto* first = reinterpret_cast<const Vec3*>(numbers);
  return Points(first, first + rows);
}

}  // namespace

Points pointsFrom(py::handle object, const std::string& name) {
  const py::array array = arrayFrom(object, name, "fiu", "an array of shape (n, 3)");
  if (array.ndim() == 1 && array.size() == 0) return {};
  if (array.ndim() != 2 || array.shape(1) != 3)
    wrongValue(name, "expects an array of shape (n, 3), got " + shapeOf(array));
  const Plain<double> numbers = plain<double>(array);
  const double* from = numbers.data();
  const std::size_t rows = rowsOf(numbers);
  const py::gil_scoped_release unlocked;
  Points out = copied(from, rows);
  parallelBlocks(rows, kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (!isFinite(out[i])) wrongValue(name, fmt::format("row {} is not finite", i));
  });
  return out;
}

std::vector<Triangle> trianglesFrom(py::handle object, const std::string& name,
                                    std::size_t vertices) {
  const py::array array = arrayFrom(object, name, "iu", "an array of whole numbers");
  if (array.ndim() != 2 || array.shape(1) != 3)
    wrongValue(name, "expects an array of shape (m, 3), got " + shapeOf(array));
  const Plain<std::int64_t> numbers = plain<std::int64_t>(array);
  const std::int64_t* from = numbers.data();
  std::vector<Triangle> out(rowsOf(numbers));
  for (std::size_t t = 0; t < out.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int64_t v = from[3 * t + c];
      if (v < 0 || static_cast<std::size_t>(v) >= vertices)
        wrongValue(name, fmt::format("row {} has vertex {}, there are {} (counted from 0)", t, v,
                                     vertices));
      out[t][c] = static_cast<int>(v);
    }
  return out;
}

Matrix matrixFrom(py::handle object, const std::string& name, std::size_t rows, bool mayBeNan) {
  const py::array array = arrayFrom(object, name, "fiu", "an array of numbers");
  if ((array.ndim() != 1 && array.ndim() != 2) || array.size() == 0)
    wrongValue(name, "expects an array of shape (n,) or (n, channels), got " + shapeOf(array));
  if (rows > 0 && rowsOf(array) != rows)
    wrongValue(name,
               fmt::format("expects {} rows, got an array of shape {}", rows, shapeOf(array)));
  const Plain<double> numbers = plain<double>(array);
  Matrix out(rowsOf(array), array.ndim() == 1 ? 1 : static_cast<std::size_t>(array.shape(1)));
  const double* from = numbers.data();
  for (std::size_t i = 0; i < out.rows(); ++i)
    for (std::size_t k = 0; k < out.columns(); ++k) {
      out(i, k) = from[i * out.columns() + k];
      if (!mayBeNan && !std::isfinite(out(i, k)))
        wrongValue(name, fmt::format("row {} is not finite", i));
    }
  return out;
}

std::vector<std::int64_t> wholesFrom(py::handle object, const std::string& name, std::int64_t least,
                                     std::int64_t most) {
  const py::array array = arrayFrom(object, name, "iu", "an array of whole numbers");
  if (array.ndim() != 1) wrongValue(name, "expects an array of shape (n,), got " + shapeOf(array));
  const Plain<std::int64_t> numbers = plain<std::int64_t>(array);
  std::vector<std::int64_t> out(numbers.data(), numbers.data() + numbers.size());
  for (const std::int64_t n : out)
    if (n < least || n > most)
      wrongValue(name, fmt::format("has {}, which is not in [{}, {}]", n, least, most));
  return out;
}

bool isArrayLike(py::handle object) {
  return py::isinstance<py::array>(object) || py::isinstance<py::list>(object);
}

py::array_t<double> arrayOf(const Points& points) {
  return filled({signedSize(points.size()), 3}, [&](std::size_t i, double* to) {
    to[0] = points[i].x;
    to[1] = points[i].y;
    to[2] = points[i].z;
  });
}

py::array_t<double> arrayOf(Matrix matrix) {
  const auto [kept, owner] = keptBy(std::move(matrix));
  const py::ssize_t rows = signedSize(kept->rows());
  return {{rows, signedSize(kept->columns())}, {kSize, rows * kSize}, kept->data(), owner};
}

py::array_t<double> arrayOf(const std::vector<Mat3>& matrices) {
  return filled({signedSize(matrices.size()), 3, 3}, [&](std::size_t i, double* to) {
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) to[3 * r + c] = matrices[i][r][c];
  });
}

py::array_t<double> gradientsOf(Matrix gradients) {
  const auto [kept, owner] = keptBy(std::move(gradients));
  const py::ssize_t rows = signedSize(kept->rows()), channels = signedSize(kept->columns() / 3);
  return {{rows, channels, py::ssize_t(3)},
          {kSize, 3 * rows * kSize, rows * kSize},
          kept->data(),
          owner};
}

py::array_t<std::int32_t> arrayOf(const std::vector<Triangle>& triangles) {
  py::array_t<std::int32_t> out({signedSize(triangles.size()), py::ssize_t(3)});
  std::int32_t* to = out.mutable_data();
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c) to[3 * t + c] = triangles[t][c];
  return out;
}

py::array_t<double> arrayOf(const Vec3& vector) {
  const double values[] = {vector.x, vector.y, vector.z};
  return py::array_t<double>(3, values);
}

}  // namespace innermap::python
