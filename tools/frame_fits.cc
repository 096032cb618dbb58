#include "frame_fits.h"

#include <fmt/format.h>

#include "innermap/core/error.h"
#include "innermap/mesh/read.h"
#include "map_report.h"

namespace innermap::tool {
namespace {

constexpr std::size_t kKept = 3;  // frames before the one asked for

}  // namespace

FrameFitter makeFrameFitter(const std::string& rest, const FrameFitterSettings& settings,
                            Context& context) {
  Mesh mesh;
  context.timed("read", [&] { mesh = readMesh(rest, {context.progress()}); });
  SourceBoundary source = makeSourceBoundary(std::move(mesh), {context.progress()});
  tell(source.notes, source.warnings, source.seconds, context);
  reportSource(source, context.report());
  try {
    FrameFitter fitter(std::move(source), settings);
    tell({}, {}, fitter.seconds(), context);
    reportFitter(fitter, settings, context.report());
    return fitter;
  } catch (const SettingError& error) {  // options are called as the settings are
    throw DataError(std::string("--") + error.what());
  }
}

std::shared_ptr<const FrameFit> FrameFits::fit(std::size_t index) const {
  const FrameFile& frame = frames_.all[index];
  Mesh mesh;
  context_.timed(
      "read", [&] { mesh = readMeshLike(frame.path, fitter_.rest().mesh, {context_.progress()}); });
  auto fit = std::make_shared<const FrameFit>(fitter_.fit(mesh, {context_.progress()}));
  addSeconds(context_.report().seconds, fit->seconds);
  for (const std::string& warning : fit->warnings)
    context_.warning(fmt::format("frame {}: {}", frame.number, warning));
  return fit;
}

std::shared_ptr<const FrameFit> FrameFits::at(std::size_t index) {
  while (!kept_.empty() && kept_.begin()->first + kKept < index) kept_.erase(kept_.begin());
  const auto known = kept_.find(index);
  if (known != kept_.end() && known->second) return known->second;
  kept_[index] = nullptr;
  return kept_[index] = fit(index);
}

std::shared_ptr<const FrameFit> FrameFits::tryAt(std::size_t index) {
  const auto known = kept_.find(index);
  if (known != kept_.end()) return known->second;
  try {
    return kept_[index] = fit(index);
  } catch (const FileError&) {
  } catch (const DataError&) {
  }
  kept_[index] = nullptr;
  return nullptr;
}

std::optional<NumberedFit> FrameFits::neighbour(std::size_t index, int step) {
  const auto count = static_cast<std::ptrdiff_t>(frames_.all.size());
  for (std::ptrdiff_t i = static_cast<std::ptrdiff_t>(index) + step; i >= 0 && i < count;
       i += step) {
    const auto place = static_cast<std::size_t>(i);
    if (const auto fit = tryAt(place)) return NumberedFit{fit.get(), frames_.all[place].number};
  }
  return {};
}

HarmonicField FrameFits::velocity(std::size_t index, double framesPerSecond) {
  const std::shared_ptr<const FrameFit> here = at(index);
  const std::optional<NumberedFit> before = neighbour(index, -1), after = neighbour(index, 1);
  if (!before && !after)
    throw DataError(
        fmt::format("{}: has no other frame to take its velocity from", frames_.all[index].path));
  return velocityAt({here.get(), frames_.all[index].number}, before, after, framesPerSecond);
}

}  // namespace innermap::tool
