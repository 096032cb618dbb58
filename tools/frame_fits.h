// The fits of a sequence's frames as they are needed, and velocities from neighbouring ones.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "frame_options.h"
#include "innermap/boundary/frame_fitter.h"

namespace innermap::tool {

// Reads the rest pose and makes its fitter; tells of both, and fills the report's "source" and
// "solve".
FrameFitter makeFrameFitter(const std::string& rest, const FrameFitterSettings& settings,
                            Context& context);

class FrameFits {
 public:
  FrameFits(const FrameFitter& fitter, const Frames& frames, Context& context)
      : fitter_(fitter), frames_(frames), context_(context) {}

  // The fit of frames.all[index]; the last few are kept. Throws FileError and DataError for a frame
  // that cannot be used.
  std::shared_ptr<const FrameFit> at(std::size_t index);

  // How the inside moves at frames.all[index], from its nearest frames before and after that can be
  // used; see velocityAt. Throws DataError when there is neither.
  HarmonicField velocity(std::size_t index, double framesPerSecond);

 private:
  std::shared_ptr<const FrameFit> fit(std::size_t index) const;
  std::shared_ptr<const FrameFit> tryAt(std::size_t index);  // none for a broken frame
  std::optional<NumberedFit> neighbour(std::size_t index, int step);

  const FrameFitter& fitter_;
  const Frames& frames_;
  Context& context_;
  std::map<std::size_t, std::shared_ptr<const FrameFit>> kept_;  // null: broken
};

}  // namespace innermap::tool
