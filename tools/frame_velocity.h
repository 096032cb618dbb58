// The fits of a sequence as they are needed, and velocities from neighbouring ones.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>

#include "frame_solver.h"

namespace innermap::tool {

class FrameFits {
 public:
  FrameFits(const FrameSolver& solver, const Frames& frames, Context& context)
      : solver_(solver), frames_(frames), context_(context) {}

  // The fit of frames.all[index]; the last few are kept. Throws as FrameSolver::solve.
  std::shared_ptr<const FrameFit> at(std::size_t index);

  // How the inside moves at frames.all[index], world units per second: the derivative of the
  // parabola through the frame and its nearest frames before and after that can be used, at their
  // numbers; of the line to one of them at an end. Throws DataError when there is neither.
  HarmonicField velocity(std::size_t index, double framesPerSecond);

 private:
  std::shared_ptr<const FrameFit> tryAt(std::size_t index);  // none for a broken frame
  std::optional<std::size_t> neighbour(std::size_t index, int step);

  const FrameSolver& solver_;
  const Frames& frames_;
  Context& context_;
  std::map<std::size_t, std::shared_ptr<const FrameFit>> kept_;  // null: broken
};

}  // namespace innermap::tool
