// Points through the frames of an animation, with all kept that the frames share.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "innermap/fit/frame_fitter.h"
#include "innermap/transfer/inverse_map.h"

namespace innermap::python {

void bindDeformer(pybind11::module_& m);

// What outside and fade_to say, where each frame may have a motion of its own.
struct FrameOutside {
  // Throws SettingError, TypeError.
  FrameOutside(double outside, const pybind11::object& fadeTo);

  OutsideSettings settings;
  bool fitted = false;  // to the best rigid motion of each frame
};

// Without the lock of the interpreter. Thread-safe.
class FrameCarrier {
 public:
  FrameCarrier(FrameFitter fitter, const FrameOutside& outside);

  const FrameFitter& fitter() const { return fitter_; }
  PlacedPoints place(const Points& points) const { return pusher_.place(points); }
  PointPusher pusherTo(const TargetBoundary& frame) const;

 private:
  FrameFitter fitter_;
  PointPusher pusher_;
  bool fitted_;
};

// With NaN for what is not carried.
Points placesOf(CarriedPoints carried);
pybind11::array_t<bool> foundOf(const PlacedPoints& placed);

}  // namespace innermap::python
