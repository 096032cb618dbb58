// `innermap deform` of geometry: frame by frame.
#pragma once

#include <string>

#include "frame_options.h"
#include "geometry_transfer.h"

namespace innermap::tool {

struct DeformGeometry {
  std::string rest, input;
  std::string output;  // a pattern of files, or a point cache
  double framesPerSecond = 24;
  const FrameOptions& frames;
  const TransferOptions& transfer;
  const GeometryOptions& geometry;

  bool cache() const;
};

// Carries the geometry through the wanted frames and writes a file for each, or one of all.
void deformGeometry(const DeformGeometry& job, const Frames& frames, Context& context);

}  // namespace innermap::tool
