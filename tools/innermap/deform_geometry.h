// `innermap deform` of geometry: frame by frame.
#pragma once

#include <string>

#include "core/frame_files.h"
#include "frame_options.h"
#include "geometry_transfer.h"

namespace innermap::tool {

struct DeformGeometry {
  std::string rest, input;
  const FrameOptions& frames;
  const TransferOptions& transfer;
  const GeometryOptions& geometry;
};

// Carries the geometry through the wanted frames and writes a file for each.
void deformGeometry(const DeformGeometry& job, const Frames& frames, const FramePattern& pattern,
                    Context& context);

}  // namespace innermap::tool
