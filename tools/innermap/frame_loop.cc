#include "frame_loop.h"

#include <fmt/format.h>

#include <algorithm>

#include "report/page/page.h"
#include "report/report_figures.h"

namespace innermap::tool {
namespace {

void sayBroken(const std::vector<FrameResult>& results, const std::string& unit, Context& context) {
  std::vector<std::string> errors;
  std::vector<std::int64_t> broken;
  const FrameResult* first = nullptr;
  for (const FrameResult& r : results) {
    errors.push_back(r.error);
    if (r.error.empty()) continue;
    if (!first) first = &r;
    broken.push_back(r.file.number);
  }
  requireOneGood(errors, unit);
  if (!first) return;
  const std::size_t count = broken.size(), told = std::min<std::size_t>(count, 20);
  broken.resize(told);
  context.failAfterwards(fmt::format("{} of {} {}s could not be used: {}{}; the first: {}", count,
                                     results.size(), unit, fmt::join(broken, ", "),
                                     count > told ? ", ..." : "", first->error));
}

}  // namespace

std::vector<FrameResult> runFrames(const Frames& frames, bool stays, Context& context,
                                   const std::function<void(std::size_t)>& body,
                                   const std::function<void(const FrameResult&)>& ended) {
  std::vector<FrameResult> results;
  const std::size_t count = frames.wanted.size();
  std::size_t finished = 0;
  FrameWatch watch;
  watch.begins = [&](std::size_t before) {
    if (before > 0 && context.timeIsUp()) return false;
    const std::int64_t number = frames.all[frames.wanted[before]].number;
    context.setPart(fmt::format("{} {} ({} of {})", frames.unit, number, before + 1, count));
    if (Page* page = context.page()) page->frame = PageFrame{number, before, count};
    return true;
  };
  watch.ended = [&](std::size_t index, FrameResult& result) {
    result.file = frames.all[index];
    if (result.error.empty())
      ++finished;
    else
      context.warning(frameLeftOut(result.file.number, result.error, frames.unit));
    if (ended) ended(result);
  };
  try {
    results = eachFrame(frames.wanted, watch, body);
  } catch (const Cancelled&) {
    if (!stays || finished == 0) throw;
    throw CancelledLate(
        fmt::format("cancelled; {} of {} {}s are in place", finished, count, frames.unit));
  }
  context.setPart("");
  if (context.page()) context.page()->frame.reset();
  const std::size_t left = count - results.size();
  if (left > 0)
    context.warning(fmt::format("--max-time ended: {} of {} {}s are left, from {} on", left, count,
                                frames.unit, frames.all[frames.wanted[results.size()]].number));
  concludeFrames(results, left, context, frames.unit);
  return results;
}

void concludeFrames(const std::vector<FrameResult>& results, std::size_t left, Context& context,
                    const std::string& unit) {
  context.report().add("frames", frameFigures(results));
  context.report().add("frames", leftFigures(left));
  sayBroken(results, unit, context);
}

DeformedFrames deformFrames(const Frames& frames, const FrameOptions& options, bool stays,
                            const std::string& columns, Context& context,
                            const std::function<DeformedRow(std::size_t)>& body) {
  DeformedFrames out;
  context.print(fmt::format("{:>8} {} {:>10} {:>10} {:>9}\n", "frame", columns, "error rms",
                            "error 99%", "seconds"));
  out.results = runFrames(frames, stays, context, [&](std::size_t index) {
    StageSeconds seconds;
    DeformedRow row = timed(seconds, "frame", [&] { return body(index); });
    context.print(fmt::format("{:>8} {} {:>10.2e} {:>10.2e} {:>9.3g}{}\n", frames.all[index].number,
                              row.counts, row.made.error->rms, row.made.error->p99,
                              seconds.front().second,
                              missedMark(row.judged.misses(options.tolerance))));
    out.rows[index] = std::move(row);
  });
  return out;
}

Figures concludeDeformed(const DeformedFrames& made, const Frames& frames,
                         const FrameOptions& options, Context& context) {
  std::vector<DeformedFrame> all(made.results.size());
  std::vector<JudgedFrame> judged;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (const auto row = made.rows.find(frames.wanted[i]); row != made.rows.end()) {
      all[i] = row->second.made;
      judged.push_back(row->second.judged);
    }
  context.judge(judgeFrames(judged, options.tolerance, options.verdict));
  return deformedFigures(all);
}

std::string secondsText(const std::vector<FrameResult>& results, Context& context) {
  double sum = 0, least = 0, most = 0;
  int count = 0;
  for (const FrameResult& r : results) {
    if (!r.error.empty()) continue;
    sum += r.seconds;
    least = count ? std::min(least, r.seconds) : r.seconds;
    most = std::max(most, r.seconds);
    ++count;
  }
  if (count == 0) return "";
  context.report().add("frames", frameSeconds(sum / count, least, most));
  return fmt::format("seconds a frame: mean {:.3g}, least {:.3g}, most {:.3g}\n", sum / count,
                     least, most);
}

}  // namespace innermap::tool
