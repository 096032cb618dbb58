// Fits of many frames on one set-up: the rest pose's solid, charges and boundary points are made
// once, and each frame is a right-hand side.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "boundary_pair.h"
#include "frame_options.h"
#include "innermap/field/boundary_error.h"
#include "innermap/solve/iterative_solver.h"

namespace innermap::tool {

// The map of one frame. All frames of a solver have the same charges, so fields can be combined
// weight by weight.
struct FrameFit {
  TargetBoundary boundary;
  HarmonicField field;
  BoundaryError error;  // at fresh points, fractions of the frame's diagonal
  int iterations = 0;
};

class FrameSolver {
 public:
  // Reads, checks and repairs the rest pose, places charges and points, factors. Fills the report's
  // "source" and "solve".
  FrameSolver(const std::string& rest, const FrameOptions& options, Context& context);

  const Mesh& rest() const { return rest_; }
  const Solid& solid() const { return *solid_; }

  // What a frame gives depends on the rest pose, the options and the frame's file alone: not on
  // which frames came before. Throws FileError and DataError for a frame that cannot be used.
  FrameFit solve(const FrameFile& frame, Context& context) const;

  // The field of the frames' weights combined; fits: at least one, of this solver.
  HarmonicField combined(const std::vector<std::pair<const FrameFit*, double>>& fits) const;

 private:
  // Points of the boundary that move with it.
  struct Samples {
    Points points;                        // world units of the rest pose
    std::vector<SurfacePoint> addresses;  // on solid().repaired().mesh
  };
  Samples samplesAt(const std::vector<SurfacePoint>& onSurface) const;
  Matrix valuesAt(const Samples& samples, const TargetBoundary& boundary) const;

  Mesh rest_;
  std::optional<Solid> solid_;
  Samples collocation_, fresh_;
  std::optional<IterativeSolver> solver_;
};

}  // namespace innermap::tool
