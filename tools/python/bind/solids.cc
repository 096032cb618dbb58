#include "bind/solids.h"

#include "bind/arrays.h"
#include "bind/keywords.h"
#include "innermap/core/run.h"

namespace py = pybind11;

namespace innermap::python {
namespace {}  // namespace

void defineContains(py::handle scope, const std::function<Solid(const py::object&)>& solidOf) {
  define<CallOptions>(
      scope,
      {"contains", "self, X",
       "Which points are inside the source's solid: (n,) bool.\n\nX: (n, 3), world units of the "
       "source."},
      [solidOf](const Arguments& a, CallOptions& o) -> py::object {
        const Solid solid = solidOf(a[0]);
        const Points points = pointsFrom(a[1], "X");
        py::array_t<bool> out(static_cast<py::ssize_t>(points.size()));
        bool* is = out.mutable_data();
        runCall(o, [&]() {
          constexpr std::size_t kBlock = 256;
          parallelBlocks(
              points.size(), kBlock,
              [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) is[i] = solid.inside(points[i]);
              },
              "looking at points");
        });
        return std::move(out);
      });
}

}  // namespace innermap::python
