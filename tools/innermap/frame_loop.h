// One frame after the other: a broken one is reported and the others go on.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "frame_options.h"
#include "report/report_figures.h"

namespace innermap::tool {

// Calls `body` for all wanted frames, with the frame's place in frames.all, and `ended` after each.
// FileErrors and DataErrors of `body` make a broken frame. On cancelling, throws CancelledLate when
// `stays` is true and frames were finished. Then calls concludeFrames().
std::vector<FrameResult> runFrames(const Frames& frames, bool stays, Context& context,
                                   const std::function<void(std::size_t)>& body,
                                   const std::function<void(const FrameResult&)>& ended = {});

// Fills the report's "frames" and sets the context's failure when some are broken. Throws DataError
// when all are.
void concludeFrames(const std::vector<FrameResult>& results, std::size_t left, Context& context,
                    const std::string& unit = "frame");

// What `deform` makes of a frame.
struct DeformedRow {
  DeformedFrame made;
  JudgedFrame judged;
  std::string counts;  // two columns of its line
};
struct DeformedFrames {
  std::vector<FrameResult> results;
  std::map<std::size_t, DeformedRow> rows;  // of the good ones, by their places in frames.all
};

// As runFrames(), with a line for each. columns: what its counts are.
DeformedFrames deformFrames(const Frames& frames, const FrameOptions& options, bool stays,
                            const std::string& columns, Context& context,
                            const std::function<DeformedRow(std::size_t)>& body);
// Judges them; the columns of the report's "frames".
Figures concludeDeformed(const DeformedFrames& made, const Frames& frames,
                         const FrameOptions& options, Context& context);

// "seconds a frame: mean 0.41, least 0.38, most 0.52" of the good ones; also into the report.
std::string secondsText(const std::vector<FrameResult>& results, Context& context);

}  // namespace innermap::tool
