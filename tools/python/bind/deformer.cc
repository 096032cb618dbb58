// innermap.Deformer: points that follow the poses of a body, and lattice(), points to follow with.
#include "bind/deformer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "bind/arrays.h"
#include "bind/carry_options.h"
#include "bind/errors.h"
#include "bind/figures.h"
#include "bind/frame_set.h"
#include "bind/lists.h"
#include "bind/meshes.h"
#include "innermap/core/memory.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

struct DeformerOptions {
  FrameFitterSettings fitting;
  double outside = 0;
  py::object fadeTo;
  CallOptions call;

  void describe(Keywords& k) {
    k.settings(innermap::describe(fitting));
    describeOutside(k, &outside, &fadeTo);
    call.describe(k);
  }
};

struct PyDeformer {
  Mesh rest;
  FrameCarrier carrier;
  PlacedPoints placed;
};

std::shared_ptr<PyDeformer> makeDeformer(const py::object& source, const py::object& inside,
                                         const DeformerOptions& o) {
  const Mesh rest = meshFrom(source, "source");
  const Points points = pointsFrom(inside, "X");
  const FrameOutside outside = frameOutside(o.outside, fadeToFrom(o.outside, o.fadeTo));
  FittingOptions fitting;
  fitting.fitting = o.fitting;
  return call(o.call, [&] {
    const std::uint64_t kept = 3 * sizeof(Vec3) * points.size();
    FrameCarrier carrier(fitterOf(makeSourceBoundary(rest), fitting, kept), outside);
    PlacedPoints placed = carrier.pusher.place(points);
    return std::make_shared<PyDeformer>(PyDeformer{rest, std::move(carrier), std::move(placed)});
  });
}

std::shared_ptr<PyDeformer> madeFrom(const py::object& source, const py::object& points,
                                     const py::kwargs& given) {
  DeformerOptions options;
  Keywords keywords("Deformer", given);
  options.describe(keywords);
  keywords.finish();
  return makeDeformer(source, points, options);
}

std::string constructorText() {
  DeformerOptions options;
  Keywords described;
  options.describe(described);
  return documented(
      fmt::format("__init__(self, source, X, *, {})", described.signature()).c_str(),
      ("source: the rest pose, a mesh as deform() takes it. X: (n, 3), world units, inside it or, "
       "with outside, around. Raises DataError, FileError, MemoryError.\n\nKeyword "
       "arguments\n\n" +
       described.docs())
          .c_str());
}

// The rest pose with the places of a frame.
Mesh frameFrom(const PyDeformer& self, const py::object& given) {
  Mesh out = self.rest;
  out.name = "frame";
  out.vertices =
      isArrayLike(given) ? pointsFrom(given, "frame") : meshFrom(given, "frame").vertices;
  if (out.vertices.size() != self.rest.vertices.size())
    wrongValue("frame", fmt::format("has {} vertices, the rest pose has {}", out.vertices.size(),
                                    self.rest.vertices.size()));
  return out;
}

py::object carryFrame(const Arguments& a, CallOptions& o) {
  const auto self = py::cast<std::shared_ptr<PyDeformer>>(a[0]);
  const Mesh frame = frameFrom(*self, a[1]);
  return arrayOf(call(o, [&] {
    const FrameSolution solution = self->carrier.fitter.solve(frame);
    const PointPusher pusher = self->carrier.pusher.to(solution.boundary.moved);
    return placesOf(pusher.push(HarmonicMap(solution.field), self->placed, false));
  }));
}

py::object measure(const Arguments& a, CallOptions& o) {
  const auto self = py::cast<std::shared_ptr<PyDeformer>>(a[0]);
  const Mesh frame = frameFrom(*self, a[1]);
  const FrameFit fit = call(o, [&] { return self->carrier.fitter.fit(frame); });
  for (const std::string& warning : fit.warnings) warn(warning);
  return dictOf(rowOf(fit));
}

struct LatticeOptions {
  int resolution = 32;
  void describe(Keywords& k) {
    k.number("resolution", &resolution, {4, 1024}, "points along the longest side");
  }
};

py::object lattice(const Arguments& a, LatticeOptions& o) {
  const Points bounds = pointsFrom(a[0], "bounds");
  if (bounds.size() != 2) wrongValue("bounds", "expects two corners, the lower and the upper");
  const Vec3 extent = bounds[1] - bounds[0], middle = 0.5 * (bounds[0] + bounds[1]);
  const double longest = std::max({extent.x, extent.y, extent.z});
  if (!(std::min({extent.x, extent.y, extent.z}) >= 0 && longest > 0))
    wrongValue("bounds", "has a lower corner that is not below the upper");
  // A cell more on either side: splines through the points need it.
  const double cell = longest / (o.resolution - 3);
  std::array<std::int64_t, 3> counts{};
  for (int k = 0; k < 3; ++k)
    counts[static_cast<std::size_t>(k)] = std::min<std::int64_t>(
        o.resolution, static_cast<std::int64_t>(std::ceil(extent[k] / cell - 1e-9)) + 3);
  innermap::requireMemory(
      "the points of a lattice",
      2 * sizeof(Vec3) * static_cast<std::uint64_t>(counts[0] * counts[1] * counts[2]),
      availableMemory(), "use a lower resolution");
  const auto first = [&](int k) {
    return middle[k] - 0.5 * cell * static_cast<double>(counts[static_cast<std::size_t>(k)] - 1);
  };
  Points points;
  for (std::int64_t w = 0; w < counts[2]; ++w)
    for (std::int64_t v = 0; v < counts[1]; ++v)
      for (std::int64_t u = 0; u < counts[0]; ++u)
        points.push_back({first(0) + cell * static_cast<double>(u),
                          first(1) + cell * static_cast<double>(v),
                          first(2) + cell * static_cast<double>(w)});
  return py::make_tuple(arrayOf(points), py::make_tuple(counts[0], counts[1], counts[2]), cell);
}

}  // namespace

FrameCarrier::FrameCarrier(FrameFitter of, const FrameOutside& outside)
    : fitter(std::move(of)), pusher(fitter.solid(), {outside.settings}, outside.fitted) {}

Points placesOf(CarriedPoints carried) {
  for (std::size_t i = 0; i < carried.points.size(); ++i)
    if (carried.fates[i] != PointFate::carried) carried.points[i] = {kNone, kNone, kNone};
  return std::move(carried.points);
}

py::array_t<bool> foundOf(const PlacedPoints& placed) {
  py::array_t<bool> out(static_cast<py::ssize_t>(placed.fates.size()));
  std::transform(placed.fates.begin(), placed.fates.end(), out.mutable_data(),
                 [](PointFate fate) { return fate == PointFate::carried; });
  return out;
}

void bindDeformer(py::module_& m) {
  py::class_<PyDeformer, std::shared_ptr<PyDeformer>> deformer(
      m, "Deformer",
      "Points that follow the poses of a body: Deformer(source, X, ...). Charges are placed and "
      "factored once, a pose is one solve. It does not change, and several threads may use it at "
      "once.");
  deformer.def(py::init(&madeFrom), py::arg("source"), py::arg("X"), constructorText().c_str());
  define<CallOptions>(
      deformer,
      {"__call__", "self, frame",
       "Where the points are in a pose, (n, 3), as deform() has them; NaN where found is "
       "False.\n\nframe: places of the rest pose's vertices, (vertices, 3), or a mesh of its "
       "connectivity. Raises DataError."},
      carryFrame);
  define<CallOptions>(
      deformer,
      {"measure", "self, frame",
       "How good the map to a pose is: a dict of boundary_rms, boundary_p99, boundary_max "
       "(fractions of the frame's diagonal), folded_fraction, outside_fraction and volume. Takes "
       "some times as long as the call itself."},
      measure);
  deformer.def_property_readonly(
      "found", [](const PyDeformer& self) { return foundOf(self.placed); },
      "Which points are carried, (n,) bool; the others lie too far outside.");
  define<LatticeOptions>(
      m,
      {"lattice", "bounds",
       "Points of a lattice of cubes around a box, at least a cell wider on each side, to carry a "
       "deformer of another program by.\n\nbounds: (2, 3), the lower and the upper corner, as "
       "(V.min(0), V.max(0)). Returns X, (n, 3), world units, the first axis fastest, as "
       "Blender's Lattice has its points; the three counts; and the edge of a cell."},
      lattice);
}

}  // namespace innermap::python
