// Points through the frames of an animation, with all kept that the frames share.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "innermap/fit/frame_fitter.h"
#include "innermap/transfer/inverse_map.h"

namespace innermap::python {

void bindDeformer(pybind11::module_& m);

// Made without the lock of the interpreter. Thread-safe.
struct FrameCarrier {
  FrameCarrier(FrameFitter of, const FrameOutside& outside);

  FrameFitter fitter;
  FramePointPusher pusher;
};

// With NaN for what is not carried.
Points placesOf(CarriedPoints carried);
pybind11::array_t<bool> foundOf(const PlacedPoints& placed);

}  // namespace innermap::python
