// innermap.Map: a map with the solid that it maps.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <mutex>
#include <optional>

#include "bind/call.h"
#include "innermap/fit/fit_map.h"
#include "innermap/fit/mapped_solid.h"
#include "innermap/transfer/inverse_map.h"

namespace innermap::python {

struct PyMap {
  std::shared_ptr<const MappedSolid> mapped;
  std::shared_ptr<const MapFit> fit;  // the same, where it was fitted here; null where it was read

  explicit PyMap(MapFit made) : PyMap(std::make_shared<const MapFit>(std::move(made))) {}
  explicit PyMap(MappedSolid read) : mapped(std::make_shared<const MappedSolid>(std::move(read))) {}

  double diagonal() const { return mapped->boundary.target.diagonal; }  // of the target
  // The inverse on a grid, made once. Without the lock of the interpreter.
  PointPuller puller() const;

 private:
  explicit PyMap(std::shared_ptr<const MapFit> made) : mapped(made), fit(std::move(made)) {}

  struct Inverse {
    std::mutex making;
    std::optional<PointPuller> made;
  };
  std::shared_ptr<Inverse> inverse_ = std::make_shared<Inverse>();
};

// (points, found) or (points, found, jacobians): NaN where a point has no place.
pybind11::tuple carriedTuple(CarriedPoints carried, bool jacobians);

void bindMap(pybind11::module_& m);
void bindMapGrids(pybind11::module_& m);  // after bindMap
void bindFit(pybind11::module_& m);
void bindLoad(pybind11::module_& m);

}  // namespace innermap::python
