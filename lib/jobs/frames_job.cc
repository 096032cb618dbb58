#include "jobs/frames_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>

#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr double kAccuracy = 1e-6;  // of sums of charges; well below what the fits leave

}  // namespace

std::vector<std::size_t> wantedFrames(const std::vector<std::int64_t>& numbers,
                                      const std::string& setting, const std::string& ranges) {
  std::optional<FrameRanges> chosen;
  if (!ranges.empty()) chosen.emplace(setting, ranges);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (!chosen || chosen->contains(numbers[i])) out.push_back(i);
  if (!out.empty()) return out;
  throw SettingError(setting, fmt::format("'{}' has none of the frames; there are {} from {} to {}",
                                          ranges, numbers.size(), numbers.front(), numbers.back()));
}

std::vector<FrameResult> eachFrame(const std::vector<std::size_t>& wanted, const FrameWatch& watch,
                                   const std::function<void(std::size_t)>& body) {
  using Clock = std::chrono::steady_clock;
  std::vector<FrameResult> out;
  for (const std::size_t index : wanted) {
    if (watch.begins && !watch.begins(out.size())) break;
    reportProgress("frames", static_cast<double>(out.size()) / static_cast<double>(wanted.size()));
    FrameResult result;
    const auto start = Clock::now();
    try {
      body(index);
    } catch (const FileError& error) {
      result.error = error.what();
    } catch (const DataError& error) {
      result.error = error.what();
    }
    result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (watch.ended) watch.ended(index, result);
    out.push_back(std::move(result));
  }
  return out;
}

void writeFrame(std::int64_t number, const std::function<void()>& write, const std::string& unit) {
  try {
    write();
  } catch (const FileError& error) {
    throw OutputFailure(fmt::format("{}; stopped at {} {}", error.what(), unit, number));
  }
}

FrameFits frameFits(const FrameFitter& fitter, std::vector<std::int64_t> numbers,
                    std::function<Mesh(std::size_t)> read,
                    std::function<void(std::size_t, const Mesh&, const FrameFit&)> fitted) {
  return {std::move(numbers),
          [&fitter, read = std::move(read), fitted = std::move(fitted)](std::size_t index) {
            const Mesh mesh = read(index);
            FrameFit fit = fitter.fit(mesh);
            if (fitted) fitted(index, mesh, fit);
            return fit;
          }};
}

void requireOneGood(const std::vector<std::string>& errors, const std::string& unit) {
  if (errors.empty() ||
      std::any_of(errors.begin(), errors.end(), [](const auto& error) { return error.empty(); }))
    return;
  throw DataError(errors.size() == 1 ? errors.front()
                                     : fmt::format("none of the {} {}s can be used; the first: {}",
                                                   errors.size(), unit, errors.front()));
}

std::string frameWarning(std::int64_t number, const std::string& warning) {
  return fmt::format("frame {}: {}", number, warning);
}

std::string frameLeftOut(std::int64_t number, const std::string& error, const std::string& unit) {
  return fmt::format("{} {} is left out: {}", unit, number, error);
}

MemoryNeed framesNeed(const FrameFitterSettings& settings, std::uint64_t others) {
  const auto at = [=](std::uint64_t sources) {
    FrameFitterSettings fewer = settings;
    fewer.sources = sources;
    fewer.collocation = 0;
    return frameFitterMemory(fewer, others);
  };
  return {fmt::format("a sequence with {} charges", settings.sources),
          frameFitterMemory(settings, others), "use a lower {resolution} or raise {max_memory}",
          SizeOption{"charges", 1, kMaxCharges, at}};
}

MemoryNeed sequenceNeed(const FrameFitterSettings& settings, const Solid& rest,
                        const MapGridSettings& grids) {
  return framesNeed(settings, mapGridMemory(rest, grids, {1, false, true}));
}

FramePushSettings pushSettings(const FrameCarry& how) {
  FramePushSettings out;
  out.push.carry = how.carry;
  out.push.outside = how.outside.settings;
  out.push.accuracy = kAccuracy;
  out.fadeToFitted = how.outside.fitted;
  out.output = how.output;
  return out;
}

std::vector<CarriedField> carriedFields(const FrameCarry& how, FrameFits& fits, std::size_t index) {
  if (!how.velocity) return {};
  return {{"velocity", fits.velocity(index, how.framesPerSecond),
           openvdb::VEC_CONTRAVARIANT_RELATIVE, how.shutter / how.framesPerSecond}};
}

std::uint64_t frameCarryMemory(const Solid& rest, const openvdb::GridPtrVec& grids,
                               const FrameCarry& how) {
  return carryMemory(rest, grids, how.output, how.outside.settings, how.carry,
                     {true, how.velocity ? 1 : 0});
}

void requireNoVelocity(const FrameCarry& how, const openvdb::GridPtrVec& grids, NamingScheme names,
                       const std::string& from, const SettingSpelling& spelled) {
  for (const openvdb::GridBase::Ptr& grid : grids)
    if (how.velocity && gridName(grid->getName(), names) == gridName("velocity", names))
      throw DataError(
          from + ": already has a grid '" + grid->getName() +
          withNames("'; leave out {velocity} or choose the others by {grids}", spelled));
}

}  // namespace innermap
